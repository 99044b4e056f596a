#!/usr/bin/env bash
# Runs a test program in which an error was planted: passes if the program notices it.
# usage: planted_error.sh PROGRAM [ARGUMENT ...]
set -u
output=$("$@" 2>&1)
status=$?
if [[ $status -eq 0 ]]; then
  echo "the planted error was not noticed"
  exit 1
fi
echo "noticed (exit status $status): $(grep -m1 -E 'emulated device:|Failure' <<<"$output")"
