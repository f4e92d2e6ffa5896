#!/usr/bin/env bash
# Runs what the documents print, as they print it, each command once: the ```sh blocks of README.md and of
# analyses/*.md, the script of README.md, and the examples in the --help of every tool, beside the scenes of analyses/scenes. my-bars.toml is the scene of
# README.md. Words after the script's name are commands to leave out.
set -euo pipefail
cd "$(dirname "$0")/.."

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
log=$scratch/log
count=0

# The lines of the blocks of one language.
blocks() {
    awk -v fence="\`\`\`$1" '/^```/ { on = !on && $0 == fence; next } on' "${@:2}"
}

run() { # directory, command
    local began=$SECONDS status=0
    (cd "$1" && bash -euo pipefail -c "$2") </dev/null >>"$log" 2>&1 || status=$?
    echo "$((SECONDS - began)) s, status $status: $2"
    # Of map-speed 1 says that this machine is slow, not that the example is wrong.
    if [[ $status != 0 && ! ($status == 1 && $2 == *map-speed*) ]]; then
        tail -n 30 "$log" >&2
        exit 1
    fi
    count=$((count + 1))
}

for skipped in "$@"; do
    grep -Fxq -- "$skipped" <(blocks sh README.md analyses/*.md | sed 's/ *#.*//') || {
        echo "left out, but in no document: $skipped" >&2
        exit 1
    }
done
while read -r command; do
    run . "$command"
done < <(blocks sh README.md analyses/*.md | sed 's/ *#.*//' | awk 'NF && !seen[$0]++' | grep -Fxv -f <(printf '%s\n' "$@"))

# The first scene of README.md; the next one is of matrices that are not here.
awk '/^```toml$/ { on = !n++; next } /^```/ { on = 0 } on' README.md >"$scratch/my-bars.toml"
cp analyses/scenes/*.toml analyses/scenes/*.msh "$scratch"
export PATH=$PWD/target/release:$PATH
for tool in $(awk -F'"' '/^\[\[bin\]\]/ { bin = 1 } bin && /^name/ { print $2; bin = 0 }' analyses/Cargo.toml); do
    cargo build --release --quiet --bin "$tool"
    # An example is a line that begins with the tool; two spaces end it.
    while read -r command; do
        run "$scratch" "$command"
    done < <("$tool" --help | sed -n "/^Examples:/,\$p" | grep -E "^  $tool( |\$)" | sed -E 's/^  //; s/  +.*//')
done

# The numbers that the documents print are those that their commands have printed.
while IFS= read -r line; do
    grep -Fxq -- "$line" "$log" || { echo "a document prints what no command printed: $line" >&2; exit 1; }
done < <(blocks text README.md analyses/*.md)
if command -v python3 >/dev/null; then
    printed=$(blocks python README.md | python3 -)
    grep -Fq -- "# $printed" README.md || { echo "the script of README.md prints $printed" >&2; exit 1; }
    count=$((count + 1))
fi
echo "$count examples run"
