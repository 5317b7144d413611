#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What a closed controller must be given so that the tool arrives: the signature's file, from Python."""
# guide: begin
import sys

import armsig

arm = armsig.load(sys.argv[1] if len(sys.argv) > 1 else "signature.yaml")
q = [0.2, -1.2, 1.0, 0.3, 0.9, -0.5]
target = arm.forward(q)  # where the tool really is at these readings
back, _ = arm.inverse(target, q)  # and how to get there
told, status = arm.compensate(target, q)  # what its own controller must be given instead
print(f"x {1e3 * told[0]:.3f} mm, instead of {1e3 * target[0]:.3f} mm")
# guide: end
