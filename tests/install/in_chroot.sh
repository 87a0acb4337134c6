#!/usr/bin/env bash
# The RUN lines of workflows/Dockerfile in fresh Debian 12 systems (debootstrap, chroot): one builds the
# package, another installs it and runs the quickstart with what the package brought.
#
#     bash tests/install/in_chroot.sh SOURCES [FOLDER]      needs root, the network, 6 GB; 10 minutes or more
#
# Exit code 77 without root or debootstrap. SIGMAFLOW_MIRROR: another mirror than deb.debian.org.
set -euo pipefail
sources="$(cd "${1:?folder of the sources}" && pwd)"
[ "$(id -u)" -eq 0 ] && command -v debootstrap >/dev/null || { echo "needs root and debootstrap"; exit 77; }
folder="${2:-$(mktemp -d)}"
mkdir -p "$folder"
mirror="${SIGMAFLOW_MIRROR:-http://deb.debian.org/debian}"

cleanup() {
    for system in build use; do
        for mounted in proc dev; do
            if mountpoint -q "$folder/$system/$mounted"; then umount -l "$folder/$system/$mounted"; fi
        done
    done
    [ -n "${2:-}" ] || rm -rf --one-file-system "$folder"
}
trap 'cleanup "$@"' EXIT

fresh_system() {
    [ -d "$folder/$1/usr" ] || debootstrap --variant=minbase bookworm "$folder/$1" "$mirror" >"$folder/$1.log"
    mount -t proc proc "$folder/$1/proc"
    mount --bind /dev "$folder/$1/dev"
    cp /etc/resolv.conf "$folder/$1/etc/resolv.conf"
    if [ -d /etc/apt/apt.conf.d ]; then cp -n /etc/apt/apt.conf.d/*proxy* "$folder/$1/etc/apt/apt.conf.d/" 2>/dev/null || true; fi
}

inside() {
    local system="$1"
    shift
    chroot "$folder/$system" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
        DEBIAN_FRONTEND=noninteractive ${http_proxy:+http_proxy="$http_proxy"} sh -ec "$@"
}

# The RUN lines of stage 1 or 2.
run_lines() {
    awk -v stage="$1" '/^FROM /{n++} n == stage && sub(/^RUN /, "")' "$sources/workflows/Dockerfile"
}

run_stage() {
    run_lines "$2" | while IFS= read -r line; do
        echo "== $1: $line"
        inside "$1" "$line" </dev/null
    done
}

fresh_system build
git -C "$sources" archive --prefix=sigmaflow/ HEAD | tar -x -C "$folder/build"
run_stage build 1

fresh_system use
cp "$folder/build/sigmaflow/build/release/sigmaflow.deb" "$folder/use/tmp/sigmaflow.deb"
run_stage use 2
inside use "sigmaflow --version"
inside use "sigmaflow validate /usr/share/sigmaflow/quickstart.json"
inside use "sigmaflow run /usr/share/sigmaflow/quickstart.json --out /tmp/quickstart"
inside use "sigmaflow verify /tmp/quickstart && sigmaflow doctor"
inside use "test -s /tmp/quickstart/snapshot.png && test -s /usr/share/man/man1/sigmaflow.1"
ls -l "$folder/use/tmp/quickstart"
echo "installed and run from the package"
