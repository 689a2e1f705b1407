#!/usr/bin/env bash
# Tries the packages of build/package/ in a clean Debian that is made for it and goes again: installs them with what
# they depend on, runs debian/tests as a user, purges them and looks for what they leave, then builds the source
# package with its Build-Depends alone, in another folder and as another user, and compares. Called by
# `./run test-package`; takes root or user namespaces, and the network.
set -euo pipefail

say() { printf 'test-package: %s\n' "$*" >&2; }
fail() { say "$*"; exit 1; }

# as_user COMMAND...: in a home of its own, with other permissions, language and time zone than the first build had.
as_user() {
  runuser --user user -- env -i HOME=/home/user PATH=/usr/bin:/bin TERM=dumb LANG=C TZ=Pacific/Kiritimati \
    DEB_BUILD_OPTIONS="parallel=${CMAKE_BUILD_PARALLEL_LEVEL:-2}" bash -c 'cd && umask 077 && "$@"' bash "$@"
}

run_test() {
  say "debian/tests/$1"
  as_user "/srv/tests/$1" >test.log 2>&1 || {
    tail -n 40 test.log >&2
    fail "debian/tests/$1 has failed"
  }
}

# Inside the clean system.
try_packages() {
  export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
  cd /srv
  useradd --create-home user

  say "installing stridor with what it depends on"
  apt-get install -qq --no-install-recommends ./stridor_*.deb >/dev/null
  run_test installed
  say "installing both packages with what they recommend"
  apt-get purge -qq stridor >/dev/null
  apt-get install -qq --install-recommends ./*.deb >/dev/null
  run_test pictures
  run_test python
  run_test documents

  say "purging"
  apt-get purge -qq stridor python3-stridor stridor-doc >/dev/null
  local left
  left=$(find / -xdev \( -path /home -o -path /srv -o -path /tmp -o -path /proc \) -prune -o -iname '*stridor*' -print)
  [[ -z $left ]] || fail "left behind: $left"
  apt-get autoremove --purge -qq >/dev/null

  say "building again with the Build-Depends alone"
  apt-get build-dep -qq --no-install-recommends ./stridor_*.dsc >/dev/null
  as_user mkdir -p a/folder
  as_user dpkg-source -x /srv/stridor_*.dsc a/folder/source >/dev/null
  as_user bash -c 'cd a/folder/source && dpkg-buildpackage -us -uc -b' >build.log 2>&1 || {
    tail -n 40 build.log >&2
    fail "the source package does not build"
  }
  local file
  for file in *.deb; do
    cmp "$file" "/home/user/a/folder/$file" || fail "$file differs when it is built again"
  done
  say "built again: the same bytes"
}

if [[ ${1:-} == inside ]]; then
  try_packages
  exit
fi

cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.."
# Called back by mmdebstrap, with the folder of the system.
if (($# == 1)); then
  cp build/package/*.deb build/package/*.dsc build/package/*.tar.xz "$1/srv/"
  cp -r debian/tests tests/package/clean_system.sh "$1/srv/"
  chroot "$1" bash /srv/clean_system.sh inside
  exit
fi
# shellcheck disable=SC1091
codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
say "making a clean Debian $codename"
mmdebstrap --quiet --variant=minbase --customize-hook="$PWD/tests/package/clean_system.sh \"\$1\"" "$codename" /dev/null \
  "deb http://deb.debian.org/debian $codename main" \
  "deb http://deb.debian.org/debian $codename-updates main" \
  "deb http://deb.debian.org/debian-security $codename-security main"
