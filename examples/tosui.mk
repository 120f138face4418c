# What the studies share: where the programs are, and how a run is made from a scene and a model.
# `make -j2` runs two cases at a time; a second `make` reruns only what changed; OUT holds everything made.
SHELL = /bin/bash
ROOT := $(dir $(lastword $(MAKEFILE_LIST)))..
BIN ?= $(if $(wildcard $(ROOT)/build/bin/sphsolve),$(ROOT)/build/bin/)
CT2MODEL = $(BIN)ct2model
SPHSOLVE = $(BIN)sphsolve
ANALYZE = $(BIN)analyze
OUT ?= out
# The sample scan; give your own with SLICES=, VOID_RATIO= and VOXEL_SIZE=.
SLICES ?= $(ROOT)/data-samples/small
VOID_RATIO ?= 0.725+-0.005
VOXEL_SIZE ?= 8.745um

.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all clean
all:
clean:
	rm -rf $(OUT)
$(OUT):
	mkdir -p $@
