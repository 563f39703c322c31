#!/usr/bin/env bash
# Runs a script in pvpython as the client of a pvserver of several processes.
#
#     served.sh PROCESSES SCRIPT.py ARGUMENT...
#
# The port is the script's last argument.
set -euo pipefail
processes=$1
shift
port=$((20000 + $$ % 20000))
log=$(mktemp)
mpiexec -n "$processes" pvserver --server-port=$port --force-offscreen-rendering >"$log" 2>&1 &
server=$!
trap 'kill $server 2>/dev/null || true; cat "$log"; rm -f "$log"' EXIT
for _ in $(seq 240); do
  ! grep -q 'Accepting connection' "$log" || break
  kill -0 $server
  sleep 0.25
done
timeout 240 pvpython "$@" $port
