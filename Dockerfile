# The image of the service; deploy/image/build.sh builds it, deploy/image/smoke.py tries it.
# Any Debian-based image with Python 3.11 or newer and its module venv can be the base.
ARG BASE=docker.io/library/python:3.11-slim

FROM ${BASE} AS system
# What libsumo needs of the system (drivora_service/system_libraries.py), and tini, which ends the
# processes that lose their parents. Nothing is drawn: an empty package stands for the drivers of
# graphics cards, which libGL asks for and which take more than all of these.
RUN mkdir -p /tmp/none/DEBIAN \
 && printf '%s\n' 'Package: libglx-mesa0' 'Version: 99' 'Architecture: all' \
      'Maintainer: Drivora' 'Description: no drivers of graphics cards' > /tmp/none/DEBIAN/control \
 && dpkg-deb --build /tmp/none /tmp/none.deb && dpkg --install /tmp/none.deb \
 && rm -r /tmp/none /tmp/none.deb \
 && apt-get update \
 && apt-get install --yes --no-install-recommends \
      libx11-6 libxext6 libxrender1 libgl1 libatomic1 tini \
 && rm -rf /var/lib/apt/lists/* /var/cache/apt/*

# Installs the pinned, hashed packages and a wheel with the networks and the web page inside.
FROM system AS build
RUN apt-get update && apt-get install --yes --no-install-recommends binutils
# Files with the certificates of package registries, if the machine that builds has its own.
ARG PIP_CERT
ARG NODE_EXTRA_CA_CERTS
ENV PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_CACHE_DIR=1 PYTHONDONTWRITEBYTECODE=1
WORKDIR /src
COPY requirements/build.txt requirements/image.txt requirements/
# Node and the other packages of the build are in an environment of their own, which is left behind.
RUN python3 -m venv /opt/build \
 && /opt/build/bin/pip install --no-compile --require-hashes -r requirements/build.txt
RUN python3 -m venv /opt/drivora \
 && /opt/drivora/bin/pip install --no-compile --require-hashes -r requirements/image.txt
# More packages, such as `--build-arg WITH=ray[default]==2.60.0`; the pinned ones keep their versions.
ARG WITH=""
RUN test -z "$WITH" || { /opt/drivora/bin/pip freeze > pinned.txt \
 && /opt/drivora/bin/pip install --no-compile --constraint pinned.txt $WITH; }
# The page by itself: what is built here is used as long as its sources do not change.
COPY drivora_service/dashboard drivora_service/dashboard
RUN /opt/build/bin/python drivora_service/dashboard/build.py
COPY . .
RUN /opt/build/bin/pip wheel --no-deps --no-build-isolation --wheel-dir /wheel . \
 && /opt/drivora/bin/pip install --no-compile --no-deps /wheel/*.whl
RUN /opt/drivora/bin/python deploy/image/trim.py
# The kernels are shipped compiled, and so are the modules that are used: after one run of all that
# the service does. An image that cannot simulate and search is not built. Not beside the sources:
# processes would import those.
WORKDIR /tmp/demo
RUN PYTHONDONTWRITEBYTECODE= NUMBA_CACHE_DIR=/kernels /opt/drivora/bin/drivora demo \
      --data-dir data --num 4 --simulations 20 --workers 1

FROM system
RUN useradd --create-home --uid 10001 drivora && install -d -o drivora -g drivora /data
# A login shell sets PATH anew; KubeRay before 1.4 starts containers by one.
RUN echo 'export PATH=/opt/drivora/bin:$PATH' > /etc/profile.d/drivora.sh
COPY --from=build /opt/drivora /opt/drivora
COPY --from=build --chown=10001:10001 /kernels /home/drivora/.cache/numba
# Ray, where it is installed: it sends no statistics, its workers have the priority of all other
# processes, and it ends none for its memory, which Drivora limits.
ENV PATH=/opt/drivora/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    NUMBA_CACHE_DIR=/home/drivora/.cache/numba \
    DRIVORA_DATA_DIR=/data \
    DRIVORA_HOST=0.0.0.0 \
    DRIVORA_LOG_FORMAT=json \
    RAY_USAGE_STATS_ENABLED=0 \
    RAY_worker_niceness=0 \
    RAY_memory_monitor_refresh_ms=0
USER drivora
WORKDIR /home/drivora
VOLUME /data
EXPOSE 8000
HEALTHCHECK --interval=15s --timeout=5s --start-period=60s \
  CMD ["python", "-c", "import urllib.request as r; r.urlopen('http://127.0.0.1:8000/readyz', timeout=4)"]
# In a container that is not its own first process, it takes over orphans all the same (-s).
ENTRYPOINT ["tini", "-s", "--", "drivora"]
CMD ["serve"]
