# Untested: no container runtime was at hand. make check on the same Debian release is what is tested.
FROM debian:12 AS build
RUN apt-get update && apt-get install -y --no-install-recommends make git
COPY . /tosui
WORKDIR /tosui
RUN make deps && make && make install PREFIX=/usr/local DESTDIR=/stage

FROM debian:12-slim
RUN apt-get update && apt-get install -y --no-install-recommends libhdf5-103-1 libtiff6 libpng16-16 libopencv-imgproc406 \
    libopencv-photo406 libconfig9 libjansson4 libxxhash0 libgomp1 gnuplot-nox && rm -rf /var/lib/apt/lists/*
COPY --from=build /stage/usr/local /usr/local
WORKDIR /data
CMD ["sphsolve", "--help"]
