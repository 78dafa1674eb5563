# For the scripts of the set-up, to be sourced: long commands that say how far they are.
#
#   with_progress NAME LOG PERCENT COMMAND ...
#     runs COMMAND with its output in LOG and prints a line of NAME every ten seconds: how much is done, and how long
#     the rest will take if it goes on at this rate. PERCENT is a function that prints the percentage done, or nothing
#     where it cannot be known. Returns what COMMAND returns; an interrupt ends it too.
#   full FOLDER    whether its disk has less than 20 MB left: a log on it cannot say so itself
#   ninja_percent, apt_percent: such functions, for a log of ninja and for the file $apt_status, to which apt writes

duration() {    # seconds, in words
  if [ "$1" -lt 90 ]; then echo "$1 s"; else echo "$((($1 + 30) / 60)) min"; fi
}

full() { [ "$(df -Pk "$1" | awk 'END { print $4 }')" -lt 20480 ]; }

ninja_percent() {
  tail -c 4000 "$log" | tr '\r' '\n' |
    awk -F '[][/]' '/^\[[0-9]+\/[0-9]+\]/ { done = $2; all = $3 } END { if (all) printf "%d", 100 * done / all }'
}

apt_percent() {    # the first half is the download, the second the installation
  tail -c 2000 "$apt_status" |
    awk -F : '/^dlstatus:/ { p = $3 / 2 } /^pmstatus:/ { p = 50 + $3 / 2 } END { if (p) printf "%d", p }'
}

with_progress() {
  local name=$1 log=$2 percent=$3 began=$SECONDS shown=$SECONDS done spent job status=0
  shift 3
  "$@" > "$log" 2>&1 &
  job=$!
  trap 'kill $job 2> /dev/null; exit 130' INT TERM
  while kill -0 $job 2> /dev/null; do
    sleep 0.5
    [ $((SECONDS - shown)) -ge 10 ] || continue
    shown=$SECONDS spent=$((SECONDS - began)) done=$($percent)
    if [ "${done:-0}" -gt 2 ]; then
      echo "[$name] $done %, about $(duration $((spent * (100 - done) / done))) left" >&2
    else
      echo "[$name] $(duration $spent) so far" >&2
    fi
  done
  wait $job || status=$?
  trap - INT TERM
  return $status
}
