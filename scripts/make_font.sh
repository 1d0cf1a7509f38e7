#!/usr/bin/env bash
# Makes src/igeo/results/font/DejaVuSans-latin.ttf, the font of the pictures, from Debian's packages
# fonts-dejavu-core and python3-fonttools. The build does without: the font is in the repository.
set -euo pipefail
cd "$(dirname "$0")/.."

/usr/bin/python3 -m fontTools.subset /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf \
    --unicodes=U+0020-007E,U+00A0-00FF,U+03BC,U+2013,U+2126,U+2212 \
    --no-hinting --layout-features= --drop-tables+=FFTM,GDEF,GPOS,GSUB,name,post \
    --output-file=src/igeo/results/font/DejaVuSans-latin.ttf
