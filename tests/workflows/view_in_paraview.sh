#!/bin/sh
# A real run, moved to another folder and opened in ParaView by its view.py: sh view_in_paraview.sh
# PROGRAM PAINTER RUN_PVPYTHON FOLDER. Exit code 77: no pvpython.
set -eu
program=$1 painter=$2 run_pvpython=$3 folder=$4
here=$(dirname "$0")
sh "$run_pvpython" -c pass > /dev/null 2>&1 || { code=$?; [ $code -eq 77 ] && exit 77; }
rm -rf "$folder"
mkdir -p "$folder"
cat > "$folder/flow.json" << 'EOF'
{"suspension": {"particles": 60, "volume_fraction": 0.45, "size_ratio": 1.4, "seed": 5},
 "steps": [{"step": "pack"}, {"step": "shear", "stress": 2, "strain": 0.4, "frame_interval": 0.1}]}
EOF
"$program" run -q "$folder/flow.json" --out "$folder/made" > /dev/null
mv "$folder/made/shear" "$folder/moved"
"$painter" draw "$folder/moved"
sh "$run_pvpython" "$here/view_in_paraview.py" "$folder/moved"
"$painter" compare "$folder/moved"
