# SPDX-License-Identifier: MIT
#
#   make                build/gicgen, build/gicrun, build/gicsweep and build/gicbench
#   make demo           the complete HMMWV for 30 s, one over the paper's road, and a page to drive it in: build/demo/
#   make bench          engines and integrators, time against error, and the 30 s: build/bench/ (QUICK=1: the short way;
#                       PARTS="drive rhs": some of drive compare rhs batch scenes precision)
#   make tables         what `make bench` measured, into README.md and tests/bench/README.md
#   make pictures       the picture of README.md's first model
#   make test           every test
#   make stress         attacks on everything, for an hour or two: build/stress/table.md (STRESS=short: ten minutes)
#   make generated      generated/*.c and *.h from models/*.veh, and models/veh.schema.json
#   make debug          the same programs with the sanitizers, in build/debug/
#   make fuzz           build/fuzz/check/fuzz, the readers under clang's libFuzzer (tests/fuzz/fuzz.c)
#   make format-check   are sources as clang-format (.clang-format) writes them?
#   make lint           clang-tidy on the C (.clang-tidy), shellcheck on the scripts (.shellcheckrc)
#   make coverage       what the tests of tests/quick.txt, or TESTS="test_read ...", reach: build/coverage/index.html
#   make deps           install the packages that all of this needs (Debian)
#   make install        into $(DESTDIR)$(PREFIX): programs, runtime core, models, manuals; make uninstall removes them
#   make clean
#
# CC, CXX, CFLAGS, LDFLAGS and BUILD (the build folder) may be given; WERROR=-Werror makes warnings errors. PREFIX is
# /usr/local by default; DESTDIR goes before it where the files are collected for a package.

BUILD := build
PREFIX := /usr/local
CFLAGS := -O3 -g
WERROR :=
WARNINGS := -Wall -Wextra -Wpedantic -Wconversion -Wshadow $(WERROR)
STANDARD := -std=c11 -D_POSIX_C_SOURCE=200809L
# no contraction: results must not depend on which multiply-add the compiler fuses
COMPILE = $(CC) $(STANDARD) $(WARNINGS) -ffp-contract=off -fPIC -fvisibility=hidden -Igenerator -Iruntime -I$(BUILD) $(CFLAGS) -MMD -MP
# of host programs; gicgen needs libyaml and minizip, what it emits nothing
LIBRARIES := -lyaml -lminizip -lgsl -lgslcblas -lklu -ltcc -lm -ldl
# of the plug-in that the engine gcp2 loads, where it is there: by the name for linking, or as programs load it
MUMPS := $(if $(shell $(CC) -E -include dmumps_c.h -x c /dev/null >/dev/null 2>&1 && echo there),$(firstword \
    $(if $(findstring /,$(shell $(CC) -print-file-name=libdmumps_seq.so)),-ldmumps_seq) \
    $(wildcard /usr/lib/*/libdmumps_seq-*.so)))

# of the plug-in that writes HDF5, where it is there; Debian has the library in variants
HDF5 := $(if $(shell for header in hdf5.h hdf5/serial/hdf5.h; do $(CC) -E -include $$header -x c /dev/null >/dev/null 2>&1 && \
    echo there; done),$(firstword $(foreach name,hdf5_serial hdf5,$(if $(findstring /,$(shell $(CC) -print-file-name=lib$(name).so)),-l$(name)))))

# of the plug-in with CVODE, where it is there; from SUNDIALS 7 on Debian's wants the headers of MPI, which come with it
mpi := $(shell pkg-config --silence-errors --cflags mpi 2>/dev/null)
SUNDIALS := $(if $(shell $(CC) $(mpi) -E -include cvode/cvode.h -x c /dev/null >/dev/null 2>&1 && echo there),-lsundials_cvode \
    -lsundials_nvecserial -lsundials_sunmatrixdense -lsundials_sunlinsoldense \
    $(if $(findstring /,$(shell $(CC) -print-file-name=libsundials_core.so)),-lsundials_core \
        $(shell pkg-config --silence-errors --libs mpi 2>/dev/null)))

# between the commands of a foreach
define newline


endef

# of an example: the folder of Ipopt's headers, where it is there
IPOPT := $(firstword $(foreach folder,coin coin-or,$(patsubst %/IpStdCInterface.h,%,$(wildcard /usr/include/$(folder)/IpStdCInterface.h))))

# folders of `make debug` and its like within this one, which another make may be filling
other_builds := $(patsubst %,-path $(BUILD)/% -prune -o,debug fuzz coverage)

models := $(basename $(notdir $(wildcard models/*.veh)))
# programs are generator/*.c and runtime/gicrun/gicrun.c; all other files stand in folders, whose order is that of
# tests/layers.txt, and go into one archive, from which a program takes what it uses
programs_of_folders := $(wildcard generator/*.c) $(wildcard runtime/gicrun/*.c runtime/gicsweep/*.c runtime/gicbench/*.c \
    runtime/plugin/*.c runtime/examples/*.c)
sources := $(filter-out $(programs_of_folders),$(wildcard generator/*/*.c runtime/*.c runtime/*/*.c))
# gicgen carries what it copies into its output, gicrun what it compiles with it
embedded := $(sort $(wildcard templates/*.in templates/fmu/*)) LICENSE runtime/gic_runtime.h runtime/gic_runtime.c runtime/gic_batch.h runtime/gic_lanes.h \
    $(addprefix runtime/,gic_road.h gic_road.c gic_road_lanes.h) $(foreach name,scene/profile_form scene/driver scene/hands run/knot_cross,runtime/$(name).h runtime/$(name).c)

objects := $(sources:%.c=$(BUILD)/%.o) $(BUILD)/embedded.o
archive := $(BUILD)/gicgen.a

.PHONY: all test format-check lint coverage test-programs list-tests stress demo bench tables pictures generated debug fuzz deps install uninstall clean
.DELETE_ON_ERROR:
.SECONDARY:

# programs look for them there, beside programs or beside their folder: runtime/host/plugin.c
plugins := $(if $(MUMPS),$(BUILD)/lib/gicgen/mumps.so) $(if $(HDF5),$(BUILD)/lib/gicgen/hdf5.so) \
    $(if $(SUNDIALS),$(BUILD)/lib/gicgen/bdf.so)

all: $(BUILD)/gicgen $(BUILD)/gicrun $(BUILD)/gicsweep $(BUILD)/gicbench $(plugins) $(BUILD)/libgic.a $(BUILD)/libgic.so $(BUILD)/live_client $(if $(IPOPT),$(BUILD)/gic_ipopt)

$(archive): $(objects)
	rm -f $@
	$(AR) rcs $@ $^

$(BUILD)/gicgen: $(BUILD)/generator/gicgen.o $(archive)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBRARIES)

$(BUILD)/gicrun: $(BUILD)/runtime/gicrun/gicrun.o $(archive)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBRARIES)

$(BUILD)/gicsweep: $(BUILD)/runtime/gicsweep/gicsweep.o $(archive)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBRARIES)

$(BUILD)/gicbench: $(BUILD)/runtime/gicbench/gicbench.o $(archive)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBRARIES)

# an example: a client of gicrun --live
$(BUILD)/live_client: $(BUILD)/runtime/examples/live_client.o
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lm

# an example: Ipopt over the gradients of the library. Its header warns of its own names
$(BUILD)/runtime/examples/ipopt.o: COMPILE += -isystem $(IPOPT) -Iruntime/host -Wno-deprecated-declarations
$(BUILD)/gic_ipopt: $(BUILD)/runtime/examples/ipopt.o $(BUILD)/libgic.a
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBRARIES) -lipopt

# the library: runtime/host/gic.h alone is seen of it. All of the archive that it needs becomes one object
library := $(patsubst %.c,$(BUILD)/%.o,$(wildcard runtime/library/*.c))

$(BUILD)/libgic.a: $(library) $(archive)
	$(CC) -r -nostdlib -o $(BUILD)/libgic.o $(library) $(archive)
	objcopy --localize-hidden $(BUILD)/libgic.o
	rm -f $@
	$(AR) rcs $@ $(BUILD)/libgic.o

# Debian's libtcc.a is for programs: a shared object can hold it once its references to the C library's variables are to
# our own, runtime/library/tcc_streams.c
libtcc := $(shell $(CC) -print-file-name=libtcc.a)
$(BUILD)/libtcc_shared.a: $(libtcc)
	objcopy $(foreach name,stdin stdout stderr environ,--redefine-sym $(name)=gicl_tcc_$(name)) $< $@

$(BUILD)/libgic.so: $(library) $(archive) $(BUILD)/libtcc_shared.a
	$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-soname,libgic.so.1 -Wl,--exclude-libs,libtcc_shared.a -o $@ $^ \
	    $(filter-out -ltcc,$(LIBRARIES)) -lpthread

$(patsubst %,$(BUILD)/runtime/plugin/%_plugin.o,mumps hdf5 cvode): COMPILE += -fvisibility=default
$(BUILD)/runtime/plugin/cvode_plugin.o: COMPILE += $(patsubst -I%,-isystem %,$(mpi))

$(BUILD)/lib/gicgen/mumps.so: $(BUILD)/runtime/plugin/mumps_plugin.o
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -shared -o $@ $^ $(MUMPS)

$(BUILD)/lib/gicgen/hdf5.so: $(BUILD)/runtime/plugin/hdf5_plugin.o
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -shared -o $@ $^ $(HDF5)

$(BUILD)/lib/gicgen/bdf.so: $(BUILD)/runtime/plugin/cvode_plugin.o
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -shared -o $@ $^ $(SUNDIALS)

# gicgen and gicrun with errors that can be planted, to see that their validation finds them: generator/base/plant.h
planting := $(shell grep -rlE --include='*.c' '"(base/plant|vehicle/plant_stores)\.h"' generator)
planted_objects := $(planting:%.c=$(BUILD)/planted/%.o)
$(BUILD)/planted/%.o: %.c
	@mkdir -p $(@D)
	$(COMPILE) -DGICGEN_PLANT -c -o $@ $<

$(BUILD)/check/gicgen_planted: $(BUILD)/generator/gicgen.o $(planted_objects) $(archive)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBRARIES)

$(BUILD)/check/gicrun_planted: $(BUILD)/runtime/gicrun/gicrun.o $(planted_objects) $(archive)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBRARIES)

# the page says how the interpreted engines were compiled
$(BUILD)/runtime/bench/machine.o: COMPILE += -DGICBENCH_FLAGS='"$(CFLAGS) -ffp-contract=off"'

# it shows what the processor can do: fused, and in lanes only where it says so
$(BUILD)/runtime/bench/peak.o: COMPILE += -O2 -ffp-contract=fast -fno-tree-vectorize -fno-tree-slp-vectorize

$(BUILD)/embed: $(BUILD)/generator/embed.o
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^

$(BUILD)/embedded.c: $(BUILD)/embed $(embedded)
	$(BUILD)/embed $(embedded) > $@

$(BUILD)/embedded.o: $(BUILD)/embedded.c
	$(COMPILE) -c -o $@ $<

# the tape's recovery has the loop of generated code, with macros for what that inserts
$(BUILD)/templates/recovery_loop.c: templates/recovery_loop.c.in
	@mkdir -p $(@D)
	sed -e '/^\/\*-/d' -e 's,/\* @\([a-z]*\)@ \*/,INSERT_\1,' $< > $@

$(BUILD)/runtime/tape/recover.o: $(BUILD)/templates/recovery_loop.c

# the runtime core and the roads go into other people's programs and stay C99
$(BUILD)/runtime/gic_runtime.o $(BUILD)/runtime/gic_road.o $(BUILD)/runtime/gic_gradient.o: STANDARD := -std=c99

$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	$(COMPILE) -c -o $@ $< 2>$@.warned; status=$$?; cat $@.warned >&2; [ -s $@.warned ] || rm -f $@.warned; exit $$status

# an object that was compiled with a warning is made again where warnings are errors
ifneq ($(WERROR),)
$(shell find $(BUILD) $(other_builds) -name '*.o.warned' -size +0 -print 2>/dev/null | while read -r file; do rm -f "$$file" "$${file%.warned}"; done)
endif

# ---- tests: each tests/unit/*.c is a program of its own, tests/tools/*.c are tools of tests/system/*.sh

reference := $(patsubst %.c,$(BUILD)/%.o,$(filter-out tests/reference/main.c,$(wildcard tests/reference/*.c)))
programs := $(basename $(notdir $(wildcard tests/unit/*.c tests/tools/*.c)))
attacking := $(basename $(notdir $(wildcard tests/stress/*.c)))
planted := gicrun_wrong_pose gicrun_wrong_velocity gicrun_wrong_acceleration gicrun_wrong_rate
variants := test_runtime_float test_runtime_fast test_dual_float test_gears_float test_road_float test_road_fast

test-programs: all $(addprefix $(BUILD)/check/,$(programs) $(variants) $(attacking) $(planted) reference reference_long \
    gicgen_planted gicrun_planted)

# headers of tests/reference and tests/random
$(BUILD)/tests/unit/%.o $(BUILD)/tests/tools/%.o: COMPILE += -Itests

# of the archive a test takes what it tests and no more
$(BUILD)/check/test_%: $(BUILD)/tests/unit/test_%.o $(archive)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lcmocka $(LIBRARIES)

# it counts allocations and calls of MUMPS, so that the plug-in is a part of it
$(BUILD)/check/test_topology: $(BUILD)/runtime/plugin/mumps_plugin.o
$(BUILD)/check/test_topology: LIBRARIES += $(MUMPS)
$(BUILD)/check/test_topology: LDFLAGS += -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=dmumps_c

# they let allocations fail
$(BUILD)/check/test_library $(BUILD)/check/test_studies: LDFLAGS += -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc

# what checks the generator shares no code with it
$(BUILD)/check/test_reference $(BUILD)/check/test_reference_mechanisms: $(BUILD)/check/%: $(BUILD)/tests/unit/%.o $(reference)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lcmocka -lquadmath -lm

$(BUILD)/check/reference: $(BUILD)/tests/reference/main.o $(reference)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lquadmath -lm

# the same in extended precision, for who asks often
$(BUILD)/check/reference_long: $(patsubst %.c,$(BUILD)/long/%.o,$(wildcard tests/reference/*.c))
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lquadmath -lm

$(BUILD)/long/%.o: %.c
	@mkdir -p $(@D)
	$(COMPILE) -DREFERENCE_LONG -c -o $@ $<

$(addprefix $(BUILD)/check/,states agree single): $(BUILD)/check/%: $(BUILD)/tests/tools/%.o $(reference)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lquadmath -lm -ldl

$(BUILD)/check/random_vehicle: $(patsubst %.c,$(BUILD)/%.o,tests/tools/random_vehicle.c $(wildcard tests/random/*.c) \
    tests/reference/support.c)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lm

# libFuzzer calls it; sanitizers see the ends of blocks from static libraries too
wrapped := exit malloc calloc realloc free strdup pool_alloc pool_grow file_read
$(BUILD)/check/fuzz: $(patsubst %.c,$(BUILD)/%.o,$(wildcard tests/fuzz/*.c)) $(archive)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) -fsanitize=fuzzer $(LDFLAGS) $(wrapped:%=-Wl,--wrap=%) -o $@ $^ \
	    -l:libyaml.a -l:libgsl.a -l:libgslcblas.a $(LIBRARIES)

$(BUILD)/check/deny_exec: $(BUILD)/tests/tools/deny_exec.o
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^

$(BUILD)/check/quad_linear: $(BUILD)/tests/tools/quad_linear.o $(reference)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lgsl -lgslcblas -lquadmath -lm

$(addprefix $(BUILD)/check/,compare_dump linearized event_errors library): $(BUILD)/check/%: $(BUILD)/tests/tools/%.o $(archive)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBRARIES)

# the runtime core and the roads in the other ways that users build them
$(BUILD)/check/%_float: VARIANT := -DGIC_FLOAT
$(BUILD)/check/%_fast: VARIANT := -ffast-math
$(BUILD)/check/test_runtime_float $(BUILD)/check/test_runtime_fast: tests/unit/test_runtime.c runtime/gic_runtime.c
$(BUILD)/check/test_dual_float: tests/unit/test_dual.c runtime/gic_runtime.c
$(BUILD)/check/test_gears_float: tests/unit/test_gears.c runtime/gic_runtime.c
$(BUILD)/check/test_road_float $(BUILD)/check/test_road_fast: tests/unit/test_road.c runtime/gic_road.c \
    runtime/gic_runtime.c
$(addprefix $(BUILD)/check/,$(variants)):
	@mkdir -p $(@D)
	$(COMPILE) $(VARIANT) -MF $@.d -o $@ $(filter %.c,$^) $(LDFLAGS) -lcmocka -lm

# gicrun with errors planted in what the engines tcc and tape compute, which checks must find: in a number of the motion of
# every subset's first body (pose 0 to 11, accelerations from 18, unit velocities from 24), in a rate

spoiled := $(shell grep -rl --include='*.c' GIC_PLANT_ runtime)
$(BUILD)/check/gicrun_wrong_pose: PLANT := -DGIC_PLANT_MOTION=1
$(BUILD)/check/gicrun_wrong_velocity: PLANT := -DGIC_PLANT_MOTION=24
$(BUILD)/check/gicrun_wrong_acceleration: PLANT := -DGIC_PLANT_MOTION=18
$(BUILD)/check/gicrun_wrong_rate: PLANT := -DGIC_PLANT_RATE=1
$(planted:%=$(BUILD)/check/%): $(BUILD)/check/%: $(BUILD)/runtime/gicrun/gicrun.o $(archive) $(spoiled)
	@mkdir -p $@.o
	for file in $(spoiled); do $(COMPILE) $(PLANT) -c -o $@.o/$$(basename $$file .c).o $$file || exit 1; done
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $(BUILD)/runtime/gicrun/gicrun.o $(patsubst %.c,$@.o/%.o,$(notdir $(spoiled))) \
	    $(archive) $(LIBRARIES)

# ---- attacks of `make stress`: tests/stress/*.c are tools of tests/stress/*.sh

$(attacking:%=$(BUILD)/check/%): $(BUILD)/check/%: $(BUILD)/tests/stress/%.o $(archive)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBRARIES)

# ---- tests that drive generated code: of the models, and of variants of the HMMWV

code := $(BUILD)/check/code
driven := hmmwv hmmwv_tires quarter_car pendulum steered undamped glider
driving := test_motion test_instance test_rolling test_keeping test_threads

# the rack moved by inputs
steered := s/^  rack: *{type: translation,/& driven: true,/; s/^  energy: .*/&\n  drive: {type: drive_force, coordinate: rack}/
# nothing takes energy away
undamped := s/damping: [0-9.]*/damping: 0/
# springs at ease at design, so that the suspension stays within reach in the air
glider := $(undamped); s/, free: [0-9.]*//

parts := $(wildcard models/parts/*.veh)

$(code)/%.c: models/%.veh $(parts) $(BUILD)/gicgen
	@mkdir -p $(@D)
	$(BUILD)/gicgen $< -o $@

$(code)/%.c: models/hmmwv.veh $(parts) $(BUILD)/gicgen
	@mkdir -p $(@D)
	sed 's|parts/|$(abspath models/parts)/|g; s/^model: .*/model: $*/; $($*)' $< > $(@:.c=.veh)
	$(BUILD)/gicgen $(@:.c=.veh) -o $@

$(code)/%.o: $(code)/%.c
	$(COMPILE) -c -o $@ $<

$(driving:%=$(BUILD)/tests/unit/%.o): $(BUILD)/%.o: %.c $(driven:%=$(code)/%.c)
	@mkdir -p $(@D)
	$(COMPILE) -I$(code) -c -o $@ $<

$(driving:%=$(BUILD)/check/%): $(BUILD)/check/%: $(BUILD)/tests/unit/%.o $(driven:%=$(code)/%.o) \
    $(BUILD)/runtime/gic_runtime.o $(BUILD)/runtime/gic_road.o
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lcmocka -lm

batched := hmmwv hmmwv_vehicle steered quarter_car

# a static rule: as an implicit one it competes with the one above, and versions of make choose differently
$(batched:%=$(code)/%_batch.c): $(code)/%_batch.c: $(code)/%.c
	$(BUILD)/gicgen --batch 8 $(firstword $(wildcard $(code)/$*.veh models/$*.veh)) -o $@

# vectors are passed between functions of one file alone, so that an older gcc's way to do it is no matter
$(batched:%=$(code)/%_batch.o): WARNINGS += -Wno-psabi
# the elementary functions of the code for one vehicle, so that bits can be compared
$(code)/hmmwv_vehicle_batch.o: WARNINGS += -DGIC_BATCH_LIBM

batches := test_batch test_batch_vehicles

$(batches:%=$(BUILD)/tests/unit/%.o): $(BUILD)/tests/unit/%.o: tests/unit/%.c $(batched:%=$(code)/%_batch.c)
	@mkdir -p $(@D)
	$(COMPILE) -I$(code) -c -o $@ $<

$(batches:%=$(BUILD)/check/%): $(BUILD)/check/%: $(BUILD)/tests/unit/%.o $(batched:%=$(code)/%.o) $(batched:%=$(code)/%_batch.o) \
    $(BUILD)/runtime/gic_runtime.o
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ -lcmocka -lm

test:
	sh tests/run.sh

list-tests:
	@echo $(filter test_%,$(programs) $(variants))

stress: test-programs fuzz
	BUILD=$(BUILD) sh tests/stress/run.sh

# ---- what people ask for

demo: all
	@mkdir -p $(BUILD)/demo
	@rm -f $(BUILD)/demo/drive.html
	@if $(BUILD)/gicrun --drive $(BUILD)/demo/drive.html models/hmmwv_vehicle.veh models/scenes/full_run.scene \
	    2>$(BUILD)/demo/drive.log; then echo "to drive: $(BUILD)/demo/drive.html"; \
	else echo "no page to drive:"; cat $(BUILD)/demo/drive.log; fi
	$(BUILD)/gicrun models/hmmwv.veh models/scenes/paper_run.scene -o $(BUILD)/demo/hmmwv.csv \
	    --plot $(BUILD)/demo/hmmwv.svg --animate $(BUILD)/demo/hmmwv.html
	$(BUILD)/gicrun models/hmmwv_vehicle.veh models/scenes/full_run.scene -o $(BUILD)/demo/full_run.csv \
	    --plot $(BUILD)/demo/full_run.svg --animate $(BUILD)/demo/full_run.html
	@echo "pictures: $(BUILD)/demo/hmmwv.svg, $(BUILD)/demo/full_run.svg"
	@echo "pages:    $(BUILD)/demo/hmmwv.html, $(BUILD)/demo/full_run.html"
	@echo "numbers:  $(BUILD)/demo/hmmwv.csv, $(BUILD)/demo/full_run.csv"

# scenes that are run with general code and with code for each alone: model/scene
compared := hmmwv/paper_run hmmwv/rough_road hmmwv/suspension_rig quarter_car/quarter_car hmmwv_tires/tires_jump \
    $(addprefix hmmwv_vehicle/,straight constant_steer cruise coasting parked full_run)

# QUICK=1: fewer repetitions and settings; PARTS: some of these
PARTS := drive rhs batch scenes precision compare
measured_drive := --drive -o $(BUILD)/bench/full_run models/hmmwv_vehicle.veh models/scenes/full_run.scene
measured_compare := -o $(BUILD)/bench models/hmmwv.veh models/scenes/paper_run.scene models/scenes/spin.scene
measured_rhs := --rhs -o $(BUILD)/bench/rhs models/hmmwv.veh models/scenes/paper_run.scene
measured_batch := --batch 64 -o $(BUILD)/bench/batch models/hmmwv.veh models/scenes/paper_run.scene
measured_scenes := --scenes -o $(BUILD)/bench/scenes $(foreach run,$(compared), \
    models/$(patsubst %/,%.veh,$(dir $(run))) models/scenes/$(notdir $(run)).scene)

measured_precision := --precision -o $(BUILD)/bench/precision \
    models/hmmwv_vehicle.veh $(patsubst %,models/scenes/%.scene,full_run acceleration_braking lane_change step_steer) \
    models/hmmwv_tires.veh $(patsubst %,models/scenes/%.scene,tires_brake tires_jump)

# one part after another, the first page last, which links to the others; and how long each took, beside how many other
# programs
bench: all
	@mkdir -p $(BUILD)/bench
	@sh tests/bench/parts.sh begin $(BUILD)/bench/parts.csv $(PARTS)
	$(foreach part,$(PARTS),@sh tests/bench/parts.sh run $(BUILD)/bench/parts.csv $(part) \
	    $(BUILD)/gicbench $(if $(QUICK),--quick) $(measured_$(part))$(newline))
	$(if $(QUICK),,sh tests/bench/fleet.sh $(BUILD)/gicgen >$(BUILD)/bench/fleet.txt)
	$(if $(QUICK),,sh tests/bench/single.sh $(BUILD)/gicgen >$(BUILD)/bench/single.txt)

# what it measured, into the pages
tables:
	python3 tests/bench/tables.py $(BUILD)/bench README.md tests/bench/README.md

# pictures that pages show
pictures: $(BUILD)/gicrun
	$(BUILD)/gicrun -q models/tutorial/1_arm.veh models/tutorial/1_arm.scene -o $(BUILD)/arm.csv \
	    --plot models/tutorial/arm.svg

generated: $(BUILD)/gicgen
	@mkdir -p generated
	$(BUILD)/gicgen --schema > models/veh.schema.json
	for model in $(models); do $(BUILD)/gicgen models/$$model.veh -o generated/$$model.c || exit 1; done

debug:
	$(MAKE) BUILD=$(BUILD)/debug \
	    CFLAGS="-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer"

# without optimization, which takes two thirds of the time to compile
fuzz:
	$(MAKE) BUILD=$(BUILD)/fuzz WARNINGS= CC=clang CFLAGS="-O0 -g -fsanitize=address,undefined,fuzzer-no-link \
	    -fno-sanitize-recover=all -fno-omit-frame-pointer" $(BUILD)/fuzz/check/fuzz

c_files = $(shell find generator runtime tests -name '*.[ch]')
format-check:
	clang-format --dry-run -Werror $(c_files)

# of what programs are made of; gcc's warnings are errors in tests/run.sh, so that clang's are not asked for
lint: $(patsubst %.in,$(BUILD)/%,$(wildcard templates/recovery_loop.c.in))
	shellcheck $(shell find tests runtime .ci -name '*.sh') .ci/run
	find generator runtime -name '*.c' -not -path 'runtime/examples/ipopt.c' | xargs -n 8 -P $(shell nproc) sh -c 'clang-tidy --quiet \
	    --warnings-as-errors="*" "$$@" -- $(STANDARD) -w -Igenerator -Iruntime -I$(BUILD) -DGICBENCH_FLAGS=\"\" 2>/dev/null' sh
	$(if $(and $(IPOPT),$(wildcard runtime/examples/ipopt.c)),clang-tidy --quiet --warnings-as-errors='*' runtime/examples/ipopt.c -- $(STANDARD) -w -Iruntime/host \
	    -isystem $(IPOPT) 2>/dev/null)

# of generator and runtime, and of the generated code that tests drive directly; the last but two lines say how much. What
# a signal ends writes no counts.
TESTS := quick
coverage:
	@command -v gcovr >/dev/null || { echo "gcovr is missing: apt-get install gcovr" >&2; exit 1; }
	$(MAKE) BUILD=$(BUILD)/coverage CFLAGS="-O0 -g --coverage -fprofile-update=atomic" test-programs
	find $(BUILD)/coverage -name '*.gcda' -delete
	-BUILD=$(BUILD)/coverage sh tests/run.sh $(TESTS)
	for part in generator runtime $(BUILD)/coverage/check/code; do \
	    echo "== $$part"; gcovr --gcov-ignore-parse-errors -r . -f "$$part/" --print-summary $(BUILD)/coverage 2>&1 | grep '^[a-z]*: ' || exit 1; done
	gcovr --gcov-ignore-parse-errors -r . -f generator/ -f runtime/ --html-details $(BUILD)/coverage/index.html $(BUILD)/coverage

deps:
	sh tests/install.sh test

# ---- installing

manuals := $(wildcard generator/*.1 runtime/*/*.1)
installed_models := $(wildcard models/*.* $(foreach folder,parts tutorial controllers kc optimize roads tires scenes,models/$(folder)/*.*))
version = $(shell sed -n 's/^.define GICGEN_VERSION "\(.*\)"/\1/p' generator/base/version.h)
# a place may have blanks in it, so only the shell takes it apart
export DESTDIR PREFIX

# both number types in one archive: names differ; position-independent, for shared objects may want it
core := $(foreach part,gic_runtime gic_road gic_gradient,$(BUILD)/install/$(part).double.o $(BUILD)/install/$(part).float.o)
$(BUILD)/install/%.double.o: runtime/%.c
	@mkdir -p $(@D)
	$(COMPILE) -std=c99 -fPIC -c -o $@ $<

$(BUILD)/install/%.float.o: runtime/%.c
	@mkdir -p $(@D)
	$(COMPILE) -std=c99 -fPIC -DGIC_FLOAT -c -o $@ $<

$(BUILD)/install/libgic_runtime.a: $(core)
	rm -f $@
	$(AR) rcs $@ $^

install: all $(BUILD)/install/libgic_runtime.a
	BUILD=$(BUILD) VERSION=$(version) PLUGINS="$(plugins)" sh runtime/host/install.sh $(manuals) $(installed_models)

uninstall:
	sh runtime/host/install.sh --remove

clean:
	rm -rf $(BUILD)

# made by the compiler, not by a rule
%.d: ;

-include $(shell test -d $(BUILD) && find $(BUILD) $(other_builds) -name '*.d' -print)
