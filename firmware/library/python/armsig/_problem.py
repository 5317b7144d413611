# SPDX-License-Identifier: MIT
"""What armsig refuses."""


class Problem(ValueError):
    """A file that cannot be read or a request that is refused, in the words of the command."""
