#!/usr/bin/env bash
# From a bare Debian 12 or 13 to a baked, verified table and a rendered preview: bash cmake/demo.sh
# Options by environment: OUT=folder for the results (default out/).
source "$(dirname "$0")/setup.sh"

say "Building the tool, baking and rendering: about 5 minutes from bare on two idle cores, most of it the build"
install_packages "${packages[@]}"
build release -DSUNBEAM_BUILD_TESTS=OFF

sunbeam=build/release/bin/sunbeam
out=${OUT:-out}
mkdir -p "$out"

say "Baking the default recipe"
"$sunbeam" bake tables/recipes/sunbeam.toml -o "$out/skin.exr"

say "Verifying the table against live evaluation"
"$sunbeam" verify "$out/skin.exr" --json "$out/verify.json"

say "Rendering a preview with the table"
"$sunbeam" render tables/scenes/sphere.toml --table "$out/skin.exr" -o "$out/sphere.exr"

say "Done"
printf 'table   %s\nreport  %s\npicture %s (linear: %s)\n' \
  "$out/skin.exr" "$out/verify.json" "$out/sphere.png" "$out/sphere.exr"
