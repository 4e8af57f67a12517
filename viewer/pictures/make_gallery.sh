#!/bin/bash
# Makes the gallery of README.md: viewer/pictures/gallery/NAME.jpg from viewer/pictures/scenes/NAME.json, and says what CPU time each took.
#
#   viewer/pictures/make_gallery.sh [PROGRAM [NAME]...]
#
# PROGRAM: the built program, otherwise .build/release/kokage. NAME: a scene; otherwise all. Needs oiiotool (Debian: openimageio-tools).
# KOKAGE_DATA: folder with env/ and objects/. Without it, or where a file is missing, the scenes that need it are left out, and named.
# The avenue takes 7 GB of memory, komorebi 6, the others less than 4.
# SIZE (otherwise each scene's) and SAMPLES may be set for a quick look.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
program=${1:-$here/../../.build/release/kokage}
shift || true
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

[ -x "$program" ] || { echo "make_gallery: there is no program $program; build it or name it" >&2; exit 2; }
command -v oiiotool >/dev/null || { echo "make_gallery: oiiotool is missing; apt-get install openimageio-tools" >&2; exit 2; }

# What a scene needs of the data folder; nothing for most.
needed() {
    case $1 in
        oak_at_noon) echo env/sky_clouds_sun.hdr ;;
        teapot_under_a_maple) echo objects/utah_teapot.obj ;;
        pine_in_a_studio) echo env/studio_small_03.hdr ;;
    esac
}

# Its leaves' light to 30 %: pixels add up many leaves. A smooth object shows the noise of its own indirect light, and asks for more.
error_of() {
    case $1 in
        teapot_under_a_maple) echo 0.15 ;;
        *) echo 0.3 ;;
    esac
}

names=("$@")
if [ ${#names[@]} = 0 ]; then
    for scene in "$here"/scenes/*.json; do names+=("$(basename "$scene" .json)"); done
fi
mkdir -p "$here/gallery"
for name in "${names[@]}"; do
    file=$(needed "$name")
    if [ -n "$file" ] && [ ! -f "${KOKAGE_DATA:-/nowhere}/$file" ]; then
        echo "skipped: $name (needs $file in KOKAGE_DATA)"
        continue
    fi
    "$program" render "$here/scenes/$name.json" --quiet --error "$(error_of "$name")" ${SIZE:+--size "$SIZE"} ${SAMPLES:+--samples "$SAMPLES"} -o "$work/$name.png" --report "$work/$name.json"
    oiiotool --nosoftwareattrib "$work/$name.png" --compression jpeg:90 -o "$here/gallery/$name.jpg"
    echo "made: $name, $(sed -n 's/^  "cpu_seconds": \([0-9]*\).*/\1/p' "$work/$name.json") CPU-s"
done
ls -l "$here"/gallery/*.jpg
