#!/usr/bin/env bash
# Pictures of a model with parallax maps by Bevy, in all ways to draw it, on Mesa's software Vulkan. Fails if a shader
# does not compile, or if a picture looks as without the maps. Needs: apt-get install mesa-vulkan-drivers
#
#     integrations/bevy/pictures.sh deep.glb folder
set -euo pipefail
if [ $# -ne 2 ]; then echo "usage: pictures.sh MODEL.glb FOLDER" >&2; exit 2; fi
model=$(realpath "$1")
mkdir -p "$2"
folder=$(realpath "$2")
cd "$(dirname "$0")"
driver=$(ls /usr/share/vulkan/icd.d/lvp_icd.*.json | head -n 1)
export WGPU_BACKEND=vulkan VK_ICD_FILENAMES=$driver VK_DRIVER_FILES=$driver
cargo build --quiet --example show
show=${CARGO_TARGET_DIR:-target}/debug/examples/show

picture() {
    local name=$1
    shift
    rm -f "$folder/$name.png"
    "$show" "$model" --picture "$folder/$name.png" "$@" >"$folder/$name.txt" 2>&1 || { cat "$folder/$name.txt"; exit 1; }
    if grep -E 'ERROR|panicked' "$folder/$name.txt"; then exit 1; fi
    [ -s "$folder/$name.png" ] || { echo "$name: no picture was written" >&2; exit 1; }
}

picture plain --off
for way in "" --hard --msaa-off --prepass "--prepass --hard" "--prepass --msaa-off" --deferred; do
    name=maps$(tr -d ' ' <<<"$way")
    # Several words, and none for the first.
    # shellcheck disable=SC2086
    picture "$name" $way
    if cmp -s "$folder/$name.png" "$folder/plain.png"; then
        echo "$name: the maps show nothing" >&2
        exit 1
    fi
    grep -q 'materials with parallax maps: [1-9]' "$folder/$name.txt" || { echo "$name: no maps were read" >&2; exit 1; }
done
echo "$(ls "$folder"/*.png | wc -l) pictures in $folder"
