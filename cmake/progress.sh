# Sourced by the scripts: commands that take longer than two seconds say how far they are.
# On a terminal one line that is written over; elsewhere a line every ten seconds.

# with_progress text command...: the command's output goes to a log, of which the last line is shown with the time that has
# passed; all of it if the command fails. Ctrl-C ends the command too.
with_progress() {
  text=$1
  shift
  log=$(mktemp)
  "$@" >"$log" 2>&1 &
  command_id=$!
  trap 'stop_command; exit 130' INT
  trap 'stop_command; exit 143' TERM
  began=$(date +%s)
  told=0
  while kill -0 "$command_id" 2>/dev/null; do
    sleep 0.5
    passed=$(($(date +%s) - began))
    [ "$passed" -ge 2 ] || continue
    if [ -t 2 ]; then
      printf '\r\033[K%s: %s' "$text" "$(progress_of "$log" "$passed" | cut -c1-"$(columns_left "$text")")" >&2
    elif [ $((passed - told)) -ge 10 ] || [ "$told" -eq 0 ]; then
      printf '%s: %s\n' "$text" "$(progress_of "$log" "$passed")" >&2
      told=$passed
    fi
  done
  status=0
  wait "$command_id" || status=$?
  clear_line
  trap - INT TERM
  [ "$status" -eq 0 ] || cat "$log" >&2
  rm -f "$log"
  return "$status"
}

stop_command() {
  kill "$command_id" 2>/dev/null || :
  wait "$command_id" 2>/dev/null || :
  rm -f "$log"
  clear_line
}
clear_line() { [ ! -t 2 ] || printf '\r\033[K' >&2; }
columns_left() {
  width=$(tput cols 2>/dev/null || echo 80)
  echo $((width > ${#1} + 20 ? width - ${#1} - 3 : 20))
}

# What apt says of itself in the log (dlstatus:N:PERCENT:TEXT, pmstatus:PACKAGE:PERCENT:TEXT), with the time that is left if
# the rest goes on as it did; else the last line and the time that has passed.
progress_of() {
  awk -v passed="$2" '
    /^(dl|pm)status:/ {
      split($0, part, ":")
      stage = /^dl/ ? "download" : "install"
      percent = part[3]
      what = part[4]
      for (i = 5; i in part; ++i) what = what ":" part[i]
      next
    }
    NF { last = $0 }
    END {
      if (stage == "") { printf "%d s, %s\n", passed, last; exit }
      done = stage == "download" ? percent / 2 : 50 + percent / 2
      printf "%d %%, %d s", done, passed
      if (done >= 5) printf ", about %d s left", passed * (100 - done) / done
      printf ", %s\n", what
    }' "$1"
}
