#!/bin/sh
# SPDX-License-Identifier: MIT
# test_scenes.sh GICRUN: the table of scenes in README.md. Every scene of models/scenes/ is set up and runs to its
# first output with every model that the table names for it, and with others, a quarter of all pairs, it is refused as a
# scene for other models, which the message names.
gicrun=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# the same scenes, as short as can be, beside the same models
mkdir "$work/scenes"
for entry in "$root"/models/*.veh "$root/models/parts" "$root/models/roads" "$root/models/tires"; do
    ln -s "$entry" "$work/"
done
for scene in "$root"/models/scenes/*.scene; do
    output=$(sed -n 's/^output_step: *//p' "$scene")
    sed "s/^duration: .*/duration: ${output:?}/" "$scene" >"$work/scenes/$(basename "$scene")"
done
models=$(cd "$root/models" && echo *.veh | sed 's/\.veh//g')

# the table's rows: scenes | models
sed -n '/^| scenes in/,/^$/p' "$root/README.md" | sed -n 's/^| `/`/p' | tr -d '`,' | while IFS='|' read -r scenes fitting _; do
    for scene in $scenes; do
        for model in $models; do case $scene in "$model"_*) first=$model ;; esac done
        echo "$scene $fitting" | sed "s/each the model of its name/$scene/; s/each the model that its name begins with/$first/"
    done
done >"$work/table"
all_scenes() { (cd "$root/models/scenes" && echo *.scene | sed 's/\.scene//g' | tr ' ' '\n'); }
listed() { [ "$(cut -d' ' -f1 "$work/table" | sort)" = "$(all_scenes | sort)" ]; }
check 'the table has every scene once' listed
described() { for scene in $(all_scenes); do grep -q "^| \`$scene\.scene\` |" "$root/models/README.md" || return 1; done; }
check 'models/README.md says what happens in every scene' described

cd "$work" || exit 1
try() { "$gicrun" -q --engine tape "$1.veh" "scenes/$2.scene" -o out.csv >out 2>err; }
pairs=0
while read -r scene fitting; do
    for model in $models; do
        case " $fitting " in *" $model "*) ;; *) pairs=$((pairs + 1)) && [ $((pairs % 4)) -ne 0 ] && continue ;; esac
        try "$model" "$scene"
        status=$?
        case " $fitting " in
            *" $model "*)
                verdict $status "$scene runs with $model"
                ;;
            *)
                [ $status -eq 1 ] && grep -q "^scenes/$scene.scene:[0-9]*:[0-9]*: error: $scene is for models with " err &&
                    # those that the message names, where it names all
                    grep -Eq " and [0-9]* more; '|: $(echo "$fitting" | tr ' ' '\n' | sort | paste -sd, | sed 's/,/, /g'); '" err
                verdict $? "$scene is refused with $model"
                ;;
        esac
    done
done <table

# a name that no model beside it has is a mistake in the scene, with the nearest name
sed 's/accelerator:/acelerator:/' scenes/full_run.scene >scenes/mistaken.scene
try hmmwv_vehicle mistaken
check 'a misspelt input' grep -q "error: the model has no input 'acelerator'" err
check 'and the nearest one' grep -q "did you mean 'accelerator'" err
# models with errors beside it do not matter
echo 'gicgen: 1' >aaa.veh
try pendulum full_run
check 'a broken model beside it' grep -q "error: full_run is for models with the inputs brake, accelerator, rack: hmmwv_vehicle; 'pendulum' has no input 'brake'$" err
check 'what to run instead' grep -q "remedy: run it with hmmwv_vehicle.veh, or 'pendulum' with the scene pendulum$" err
# a coordinate that the model drives is no matter of other models
printf '%s\n' 'gicscene: 1' 'duration: 1' 'step: 0.001' 'initial: {coordinates: {rack: 0.01}}' >driven.scene
"$gicrun" "$root/models/hmmwv_vehicle.veh" driven.scene -q >out 2>err
check 'an initial value of a driven coordinate' grep -q "'hmmwv_vehicle' has no free coordinate 'rack': it is driven, and .inputs. describe" err

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
