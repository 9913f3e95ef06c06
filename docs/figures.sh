#!/usr/bin/env bash
# The pictures of docs/measured/figures.md: bash docs/figures.sh [--size WIDTHxHEIGHT] [--spp N] [--only NAME] [--out FOLDER]
# --size and --spp replace each picture's (each cell's, in a montage) own; NAME: bands portrait fig1 fig4 fig5 fig6 spectrum sheets films.
# Needs build/release/bin/sunbeam (bash cmake/demo.sh), python3-pil and fonts-dejavu-core. Tables, .exr files and the numbers of the captions (numbers_fig5.md, numbers_fig6.md) stay in build/figures.
set -euo pipefail
cd "$(dirname "$0")/.."

size='' spp='' only='' out=docs/figures work=build/figures
while [ $# -gt 0 ]; do
  case $1 in
    --size) size=$2 ;;
    --spp) spp=$2 ;;
    --only) only=$2 ;;
    --out) out=$2 ;;
    *) sed -n '2,4s/^# //p' "$0" >&2; exit 2 ;;
  esac
  shift 2
done
case $only in
  '' | bands | portrait | fig1 | fig4 | fig5 | fig6 | spectrum | sheets | films) ;;
  *) echo "--only: found '$only'; allowed: bands, portrait, fig1, fig4, fig5, fig6, spectrum, sheets, films" >&2; exit 2 ;;
esac

sunbeam=build/release/bin/sunbeam
mkdir -p "$out" "$work"
/usr/bin/python3 -c 'import PIL' || { echo "python3-pil is missing: apt-get install python3-pil fonts-dejavu-core" >&2; exit 1; }

# quietly COMMAND...: what it says goes to the log, and to the screen if it fails.
quietly() { "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }; }

# bake TABLE RECIPE [OPTION...], once
bake() {
  [ -e "$1" ] && return
  echo "baking $1"
  quietly "$sunbeam" bake "$2" -o "$1" "${@:3}"
}

# render NAME SCENE SIZE SPP [OPTION...] writes build/figures/NAME.exr and .png.
render() {
  echo "rendering $1"
  quietly "$sunbeam" render "$2" -o "$work/$1.exr" --size "${size:-$3}" --spp "${spp:-$4}" "${@:5}"
}

# flip NAME A B: the mean FLIP of two pictures; draws it as NAME_flip.png. What compare says of them stays in build/figures/log.
flip() {
  "$sunbeam" compare "$work/$2.exr" "$work/$3.exr" --png "$work/$1_flip.png" >"$work/log" 2>&1
  awk '$1 == "flip" { printf "%.4f", $2 }' "$work/log"
}

# The skin by table and twice live, by PFMC unless $estimator says otherwise: NAME_table, NAME_live and NAME_noise with their FLIP, NAME_flip.png of table against live
# and NAME_noise_flip.png of live against live; a row of numbers_FIGURE.md.
both() {
  local name=$1 scene=$2 table=$3 floor error
  render "${name}_table" "$scene" "$cell" "$samples" --table "$table" "${@:4}"
  render "${name}_live" "$scene" "$cell" "$samples" --material live --estimator "${estimator:-pfmc}" --seed 2 "${@:4}"
  render "${name}_noise" "$scene" "$cell" "$samples" --material live --estimator "${estimator:-pfmc}" --seed 3 "${@:4}"
  floor=$(flip "${name}_noise" "${name}_noise" "${name}_live")
  error=$(flip "$name" "${name}_table" "${name}_live")
  awk -v name="$name" -v error="$error" -v floor="$floor" '
    $1 == "relmse" { relmse = $2 }
    $1 == "bias" { share = 100 * $3 / $NF; z = $8; if (share < 0) share = -share; if (z < 0) z = -z
                   if (share > bias) bias = share; if (z > sigma) sigma = z }
    $1 == "blocks" { blocks = $6 }
    END { printf "| %s | %s | %s | %.5f | %.2f %% | %.1f | %.2f %% |\n", name, error, floor, relmse, bias, sigma, blocks }
  ' "$work/log" >>"$work/numbers_$figure.md"
}

# montage OUT COLUMNS [OPTION...] PICTURE...
montage() { quietly /usr/bin/python3 docs/montage.py "$out/$1.png" "$2" "${@:3}"; }

pngs() { printf "$work/%s.png " "$@"; }

# black SCENE: the scene with the recipe of albedo 0.
black() {
  sed 's/^albedo = 0.3/albedo = 0.0/' tables/recipes/sunbeam.toml >"$work/albedo0.toml"
  sed "s#\"../recipes/sunbeam.toml\"#\"albedo0.toml\"#" "tables/scenes/$1.toml" >"$work/$1_albedo0.toml"
  echo "$work/$1_albedo0.toml"
}

bake_default() { bake "$work/skin.exr" tables/recipes/sunbeam.toml; }

# Only what the figures look up: nodes of base IOR and absorption, exact there.
bake_black() {
  bake "$work/albedo0.exr" tables/recipes/sunbeam.toml --set material.albedo=0 \
    --set 'grid.base_ior=[1.0, 2.0]' --set 'grid.absorption_per_nm=[0.0, 0.7]'
}

bands() {
  render bands tables/scenes/snake_bands.toml 900x560 200
  montage bands 1 "$work/bands.png"
}

portrait() {
  render portrait tables/scenes/snake_bands.toml 900x560 256 --set 'camera.position=[1.5, -3.0, 2.0]' \
    --set 'camera.look_at=[0.35, -0.55, 1.05]' --set camera.fov_deg=24
  montage portrait 1 "$work/portrait.png"
}

fig1() {
  render fig1 tables/scenes/fig1.toml 800x500 256 --table "$work/skin.exr"
  montage fig1 1 "$work/fig1.png"
}

fig4() {
  render fig4 tables/scenes/fig4.toml 560x315 256 --table "$work/skin.exr"
  montage fig4 1 "$work/fig4.png"
}

fig5() {
  local cell=256x144 samples=96 ior nm names=() black_names=()
  for ior in 1 2; do
    for nm in 300 600 1200; do
      local keys=(--set "material[0].film_thickness_nm=$nm" --set "material[0].base_ior=$ior")
      names+=("fig5_${nm}_$ior") black_names+=("fig5_albedo0_${nm}_$ior")
      both "fig5_${nm}_$ior" tables/scenes/fig5.toml "$work/skin.exr" "${keys[@]}"
      both "fig5_albedo0_${nm}_$ior" "$(black fig5)" "$work/albedo0.exr" "${keys[@]}"
    done
  done
  local captions=(--top '300 nm|600 nm|1200 nm' --left 'n 1|n 2')
  montage fig5 3 "${captions[@]}" $(pngs "${names[@]/%/_table}")
  montage fig5_live 3 "${captions[@]}" $(pngs "${names[@]/%/_live}")
  montage fig5_flip 3 --top '300 nm|600 nm|1200 nm' --left 'n 1|n 2|n 1, noise|n 2, noise' \
    $(pngs "${names[@]/%/_flip}" "${names[@]/%/_noise_flip}")
  montage fig5_albedo0 3 "${captions[@]}" $(pngs "${black_names[@]/%/_table}")
}

fig6() {
  local cell=216x122 samples=96 shape names=() checks=() black_names=()
  for shape in sphere torus snake; do
    local scene=tables/scenes/fig6_$shape.toml f=fig6_$shape
    render "${f}_a" "$scene" "$cell" "$samples" --material diffuse --set 'material[0].scales.height=0'
    render "${f}_b" "$scene" "$cell" "$samples" --material diffuse
    both "${f}_c" "$scene" "$work/skin.exr" --set 'material[0].absorption_per_nm=0'
    both "${f}_d" "$scene" "$work/skin.exr"
    both "${f}_albedo0_c" "$(black "fig6_$shape")" "$work/albedo0.exr" --set 'material[0].absorption_per_nm=0'
    both "${f}_albedo0_d" "$(black "fig6_$shape")" "$work/albedo0.exr"
    names+=("${f}_a" "${f}_b" "${f}_c_table" "${f}_d_table")
    checks+=("${f}_c_live" "${f}_d_live" "${f}_c_flip" "${f}_d_flip")
    black_names+=("${f}_albedo0_c_table" "${f}_albedo0_d_table" "${f}_albedo0_c_live" "${f}_albedo0_d_live"
      "${f}_albedo0_c_flip" "${f}_albedo0_d_flip")
  done
  montage fig6 4 --top '(a)|(b)|(c)|(d)' $(pngs "${names[@]}")
  montage fig6_live 4 --top '(c) live|(d) live|(c) FLIP|(d) FLIP' $(pngs "${checks[@]}")
  montage fig6_albedo0 6 --top '(c) table|(d) table|(c) live|(d) live|(c) FLIP|(d) FLIP' $(pngs "${black_names[@]}")
}

# Three wavelengths above, the whole spectrum below; both live and exact.
spectrum() {
  local scene=$work/fig5_rgb3.toml nm three=() whole=()
  sed 's/mode = "full"/mode = "rgb3"/' tables/recipes/sunbeam.toml >"$work/rgb3.toml"
  sed 's#"../recipes/sunbeam.toml"#"rgb3.toml"#' tables/scenes/fig5.toml >"$scene"
  for nm in 300 600 1200; do
    render "rgb3_$nm" "$scene" 256x144 96 --material live --set "material[0].film_thickness_nm=$nm"
    render "full_$nm" tables/scenes/fig5.toml 256x144 96 --material live --set "material[0].film_thickness_nm=$nm"
    three+=("rgb3_$nm") whole+=("full_$nm")
  done
  montage spectrum 3 --top '300 nm|600 nm|1200 nm' --left '3 waves|full' $(pngs "${three[@]}" "${whole[@]}")
}

# sheet NAME KEY VALUE...: film thickness from left to right, the values of KEY from top to bottom.
sheet() {
  local name=$1 key=$2 value nm names=() thicknesses='100 200 300 400 500 600 800 1000 1500'
  for value in "${@:3}"; do
    for nm in $thicknesses; do
      render "${name}_${nm}_$value" tables/scenes/ball.toml 80x80 128 --table "$work/skin.exr" \
        --set "material[0].film_thickness_nm=$nm" --set "material[0].$key=$value"
      names+=("${name}_${nm}_$value")
    done
  done
  montage "$name" 9 --top "${thicknesses// /|}" --left "$(IFS='|'; echo "${*:3}")" $(pngs "${names[@]}")
}

sheets() {
  sheet sheet_ior base_ior 1.0 1.25 1.5 1.75 2.0
  sheet sheet_absorption absorption_per_nm 0.0 0.1 0.3 0.7
}

# look RECIPE: the scene of one ball with this recipe.
look() {
  local scene=$work/look_$(basename "$1")
  sed "s#\"../recipes/titanium.toml\"#\"$(realpath --relative-to="$work" "$1")\"#" tables/scenes/look.toml >"$scene"
  echo "$scene"
}

# bake_look RECIPE: the table of this shipped recipe.
bake_look() { bake "$work/table_$1.exr" "tables/recipes/$1.toml"; }

# oxides NAME NM...: balls of the table NAME with films of these thicknesses.
oxides() {
  local name=$1 nm
  for nm in "${@:2}"; do
    render "${name}_$nm" "$(look "tables/recipes/$name.toml")" 104x104 256 --table "$work/table_$name.exr" --set "material[0].film_thickness_nm=$nm"
  done
}

# Films of layers: six looks by table and live, oxides that grow on titanium and on steel, platelets of ever less even thickness (live).
films() {
  local name scene spread spreads='0 0.05 0.1 0.2 0.3' cell=220x220 samples=320 estimator=exact
  /usr/bin/python3 docs/film_scenes.py "$work" ../../tables/recipes
  for name in chrysochroa morpho nacre titanium steel oil; do
    bake_look "$name"
    case $name in
      chrysochroa) scene=$work/beetle.toml ;;
      oil) scene=$work/slick.toml ;;
      *) scene=$(look "tables/recipes/$name.toml") ;;
    esac
    both "look_$name" "$scene" "$work/table_$name.exr"
  done
  montage films 3 $(pngs look_{chrysochroa,morpho,nacre,titanium,steel,oil}_table)

  oxides titanium 24 40 48 64 110 140 192
  montage titanium 7 --top '24 gold|40 purple|48 blue|64 light blue|110 yellow|140 pink|192 green' $(pngs titanium_{24,40,48,64,110,140,192})
  oxides steel 20 34 41 53 80
  montage steel 5 --top '20 straw|34 brown|41 purple|53 blue|80 grey blue' $(pngs steel_{20,34,41,53,80})

  for spread in $spreads; do
    sed "s/^thickness_spread = 0.05/thickness_spread = $spread/; s/^albedo = 0.5/albedo = 0.03/" tables/recipes/nacre.toml >"$work/spread_$spread.toml"
    render "spread_$spread" "$(look "$work/spread_$spread.toml")" 130x130 256 --material live
  done
  montage spread 5 --top "${spreads// /|}" $(pngs $(printf 'spread_%s ' $spreads))
}

[ "$only" = films ] || bake_default
case ${only:-all} in fig5 | fig6 | all) bake_black ;; esac
for figure in ${only:-bands portrait fig1 fig4 fig5 fig6 spectrum sheets films}; do
  rm -f "$work/numbers_$figure.md"
  start=$SECONDS
  "$figure"
  echo "$figure: $((SECONDS - start)) s"
done
