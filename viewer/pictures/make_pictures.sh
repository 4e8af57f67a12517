#!/bin/bash
# Makes the pictures of README.md in viewer/pictures: oak.jpg, species.jpg, teapot.jpg, relief.jpg and contact_sheet.jpg.
#
#   viewer/pictures/make_pictures.sh [PROGRAM]
#
# PROGRAM: the built program, otherwise .build/release/kokage. Needs oiiotool (Debian: openimageio-tools).
# KOKAGE_DATA: folder with trees/, env/ and objects/. Without it, or where a file is missing, the pictures that need it are left out, and named.
# What oiiotool was called with, paths and all, is kept out of the pictures.
# SIZE (of one picture of the sheet, otherwise 384x288) and SAMPLES (otherwise 24) may be set for a quick look.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
program=${1:-$here/../../.build/release/kokage}
size=${SIZE:-384x288}
samples=${SAMPLES:-24}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

[ -x "$program" ] || { echo "make_pictures: there is no program $program; build it or name it" >&2; exit 2; }
command -v oiiotool >/dev/null || { echo "make_pictures: oiiotool is missing; apt-get install openimageio-tools" >&2; exit 2; }

trees=(oak eztree_oak_medium eztree_ash_large quaternius_willow_2 quaternius_tex_birch_8 quaternius_tex_pine_1)
environments=(sky sky_clouds_sun.hdr sunset_venice.exr overcast_potsdamer_platz.hdr studio_small_03.hdr)

# Where a tree or an environment is; nothing if it is not there.
tree_source() {
    if [ "$1" = oak ]; then echo oak; elif [ -f "${KOKAGE_DATA:-/nowhere}/trees/$1.glb" ]; then echo "$KOKAGE_DATA/trees/$1.glb"; fi
}
environment_source() {
    if [ "$1" = sky ]; then echo sky; elif [ -f "${KOKAGE_DATA:-/nowhere}/env/$1" ]; then echo "$KOKAGE_DATA/env/$1"; fi
}

"$program" shade oak --image "$work/oak.png" --image-size 1280x800 --samples 48
oiiotool --nosoftwareattrib "$work/oak.png" --compression jpeg:88 -o "$here/oak.jpg"

# The ten species in summer, those that shed their leaves bare, and three in their best season.
sheet=()
for tile in {oak,beech,birch,maple,willow,aspen,pine,spruce,cypress,cherry}:summer {oak,beech,birch,maple,willow,aspen,cherry}:winter \
    cherry:blossom maple:autumn oak:autumn; do
    "$program" shade "${tile%:*}" --quiet --error 0.1 --set "season=${tile#*:}" --image "$work/$tile.png" --image-size 360x360 --samples "$samples"
    sheet+=("$work/$tile.png")
    echo "made: $tile"
done
oiiotool --nosoftwareattrib "${sheet[@]}" --mosaic:pad=4 5x4 --compression jpeg:85 -o "$here/species.jpg"

# The sum over every pixel of the surroundings; the same through a reflection map; how far apart they are; the same without the horizon's correction.
teapot=$work/teapot/teapot-forest_slope-hdr-mixed.png
"$program" bench reflection --quiet --experiment teapot -o "$work/teapot"
if [ -f "$teapot" ]; then
    oiiotool --nosoftwareattrib "$teapot" --compression jpeg:90 -o "$here/teapot.jpg"
else
    echo "skipped: the teapot (needs env/forest_slope.hdr and objects/utah_teapot.obj in KOKAGE_DATA)"
fi

# A ball of bark in light, and the reads of each of its pixels, method by method.
"$program" bench relief --quiet --quick --experiment pictures -o "$work/relief"
oiiotool --nosoftwareattrib "$work/relief/relief-bark-256.png" --resize 1568x0 --compression jpeg:90 -o "$here/relief.jpg"

tiles=() rows=0 columns=0
for environment in "${environments[@]}"; do
    [ -n "$(environment_source "$environment")" ] && columns=$((columns + 1)) || echo "skipped: $environment (not in KOKAGE_DATA)"
done
for tree in "${trees[@]}"; do
    source=$(tree_source "$tree")
    if [ -z "$source" ]; then
        echo "skipped: $tree (not in KOKAGE_DATA)"
        continue
    fi
    rows=$((rows + 1))
    for environment in "${environments[@]}"; do
        light=$(environment_source "$environment")
        [ -n "$light" ] || continue
        tile=$work/$tree-${environment%.*}.png
        "$program" shade "$source" --quiet --error 0.1 --environment "$light" --image "$tile" --image-size "$size" --samples "$samples"
        tiles+=("$tile")
        echo "made: $tree, $environment"
    done
done
oiiotool --nosoftwareattrib "${tiles[@]}" --mosaic:pad=6 "${columns}x$rows" --compression jpeg:85 -o "$here/contact_sheet.jpg"
ls -l "$here"/*.jpg
