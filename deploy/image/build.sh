#!/usr/bin/env bash
# Builds the image of the Dockerfile with buildah (no daemon, no root needed) or docker.
#   usage: build.sh [--tag NAME] [OPTION OF `buildah build` OR `docker build` …]
# Exits with 3 if no image can be built here, and with 1 if the build has failed.
# BASE names the base image. Without it, that of the Dockerfile is used where it can be pulled;
# elsewhere buildah makes a base from Debian's packages, by debootstrap, which needs root.
set -euo pipefail
cd "$(dirname "$0")/../.."
tag=drivora
given=()
while [ $# -gt 0 ]; do
  case $1 in
    --tag) tag=${2:?--tag needs a name}; shift 2 ;;
    *) given+=("$1"); shift ;;
  esac
done

if command -v buildah > /dev/null; then
  engine=buildah
elif command -v docker > /dev/null && docker info > /dev/null 2>&1; then
  engine=docker
else
  echo "no image was built: neither buildah nor a running docker is here" >&2
  exit 3
fi

# A base of Debian's own packages, made once.
debian_base() {
  local made=localhost/drivora-base:bookworm folder container
  if ! buildah inspect --type image "$made" > /dev/null 2>&1; then
    command -v debootstrap > /dev/null && [ "$(id -u)" = 0 ] || {
      echo "no image was built: $base cannot be pulled, and debootstrap (as root) is not here" >&2
      exit 3
    }
    folder=$(mktemp -d)
    debootstrap --variant=minbase --include=python3,python3-venv,ca-certificates \
      bookworm "$folder" ${DEBIAN_MIRROR:+"$DEBIAN_MIRROR"} >&2 || {
      echo "no image was built: debootstrap has failed" >&2
      exit 3
    }
    rm -rf "$folder"/var/lib/apt/lists/* "$folder"/var/cache/apt/* "$folder"/var/log/* \
      "$folder"/usr/share/doc/* "$folder"/usr/share/man/* "$folder"/usr/share/locale/*
    tar --directory "$folder" --exclude='./proc/*' --exclude='./sys/*' --exclude='./dev/*' \
      --create --file "$folder.tar" .
    if ! { container=$(buildah from scratch) \
      && buildah add --quiet "$container" "$folder.tar" / > /dev/null \
      && buildah commit --quiet --rm "$container" "$made" > /dev/null; }; then
      echo "no image was built: buildah cannot make one here" >&2
      exit 3
    fi
    rm -rf "$folder" "$folder.tar"
  fi
  base=$made
}

if [ $engine = docker ]; then
  docker build ${BASE:+--build-arg BASE="$BASE"} --tag "$tag" "${given[@]}" . || exit 1
  exit 0
fi
base=${BASE:-$(sed -n 's/^ARG BASE=//p' Dockerfile)}
[ -n "${BASE:-}" ] || buildah pull --quiet "$base" > /dev/null 2>&1 || debian_base
options=(--isolation "${BUILDAH_ISOLATION:-chroot}")
# A process without the rights for it, as in many containers, is no reason to call the image bad.
if ! { probe=$(buildah from "$base") && buildah run "${options[@]}" "$probe" -- true; }; then
  echo "no image was built: buildah can run nothing in a container here" >&2
  exit 3
fi
buildah rm "$probe" > /dev/null
# Certificates that this machine trusts, so that registries are reached as from it.
certificates=/etc/ssl/certs/ca-certificates.crt
if [ -f $certificates ]; then
  options+=(--volume "$certificates:/etc/ssl/certs/ca-certificates.crt:ro")
  for name in PIP_CERT NODE_EXTRA_CA_CERTS; do options+=(--build-arg "$name=$certificates"); done
fi
# Of docker's form: the other has no health check. The exit code of a step is that of the build.
buildah build --format docker "${options[@]}" --build-arg BASE="$base" --tag "$tag" "${given[@]}" . \
  || exit 1
