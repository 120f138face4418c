# What the studies share: where the programs are, and how a run is made from a scene and a model.
# `make -j2` runs two cases at a time; a second `make` reruns only what changed, given variables included; OUT holds
# everything made.
SHELL = /bin/bash
ROOT := $(dir $(lastword $(MAKEFILE_LIST)))..
BIN ?= $(if $(wildcard $(ROOT)/build/bin/sphsolve),$(ROOT)/build/bin/)
override BIN := $(patsubst %//,%/,$(addsuffix /,$(BIN)))
CT2MODEL = $(BIN)ct2model
SPHSOLVE = $(BIN)sphsolve
ANALYZE = $(BIN)analyze
OUT ?= out
# What is made with a variable depends on $(call given,NAME...): files that change when the values do.
given = $(foreach n,$(1),$(OUT)/.$(n)$(shell mkdir -p '$(OUT)'; echo '$($(n))' | cmp -s - '$(OUT)/.$(n)' || echo '$($(n))' > '$(OUT)/.$(n)'))
# The sample scan; give your own with SLICES=, VOID_RATIO= and VOXEL_SIZE=.
SLICES ?= $(ROOT)/data-samples/small
VOID_RATIO ?= 0.725+-0.005
VOXEL_SIZE ?= 8.745um
# Two names to make, of which `clean` would remove both.
$(foreach n,OUT SLICES,$(if $(word 2,$($(n))),$(error $(n)="$($(n))": make takes no name with a space in it; give a link to it)))

# $(call cubes,N...): sizes of models N voxels wide, in the shape of the scan.
cubes = $(shell $(CT2MODEL) info $(SLICES) --voxel-size $(VOXEL_SIZE) --json 2> /dev/null | python3 ../cubes.py $(1))

SCAN := $(wildcard $(SLICES)/*) $(SLICES) $(call given,SLICES VOID_RATIO VOXEL_SIZE)

.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all clean
all:
clean:
	rm -rf $(OUT)
$(OUT):
	mkdir -p $@
