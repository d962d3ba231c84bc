#!/usr/bin/env bash
# Installs the Debian packages Risorius needs: tools/packages.txt, and with --test also tools/packages-test.txt.
# Works as root and through sudo; does nothing when all of them are present.
set -euo pipefail
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)

lists=("$here/packages.txt")
for argument in "$@"; do
  case "$argument" in
    --test) lists+=("$here/packages-test.txt") ;;
    *) echo "setup.sh: unknown option '$argument' (the only one is --test)" >&2; exit 2 ;;
  esac
done

missing=()
while read -r package; do
  [[ -z "$package" || "$package" == \#* ]] && continue
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ "$status" == installed ]] || missing+=("$package")
done < <(cat -- "${lists[@]}")

if ((${#missing[@]} == 0)); then
  echo "setup: all Debian packages are present"
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || { echo "setup.sh: root or sudo is needed to install: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "setup: installing ${missing[*]}"
"${as_root[@]}" apt-get -o DPkg::Lock::Timeout=300 update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
