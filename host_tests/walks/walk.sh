# shellcheck shell=bash
# What the walks have in common. Arguments of each: the root of the sources, the folder of armsig, the folder of armsigd.
set -euo pipefail
# shellcheck disable=SC2034  # for those that read this
root=$1
PATH=$2:$3:$PATH
walk=$(basename "$0")
work=$(mktemp -d)
daemon=
# The controller writes what its checks have learnt when it ends.
leave() {
  if [ -n "$daemon" ] && kill "$daemon" 2>/dev/null; then wait "$daemon" || true; fi
  rm -rf "$work"
}
trap leave EXIT
cd "$work"

fail() { echo "$walk: $*" >&2; exit 1; }
# do_it COMMAND...: it has to end with 0; what it said is in `said`.
do_it() { said=$("$@" 2>&1) || fail "$* ends with $?: $said"; }
# refuse STATUS WORDS COMMAND...: it has to end with STATUS, and to say WORDS.
refuse() {
  local status=0 wanted=$1 words=$2
  shift 2
  said=$("$@" 2>&1) || status=$?
  [ "$status" -eq "$wanted" ] || fail "$* ends with $status and not $wanted: $said"
  [[ $said = *"$words"* ]] || fail "$* does not say '$words': $said"
}
# has FILE PATTERN
has() { grep -qE -- "$2" "$1" || fail "$1 lacks $2: $(head -c 600 "$1")"; }
