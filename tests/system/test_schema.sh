#!/bin/sh
# SPDX-License-Identifier: MIT
# test_schema.sh GICGEN: the JSON Schema of model files. What the reader reads fits it, and what has a wrong structure (unknown, missing
# and misplaced keys, wrong kinds) does not; the committed schema, the list of keys and the pages FORMAT.md, TIRES.md and POWERTRAIN.md are those of the reader.
gicgen=$1
root=$(dirname "$0")/../..
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

"$gicgen" --schema >"$work/schema" && cmp "$work/schema" "$root/models/veh.schema.json"
verdict $? "models/veh.schema.json is not what --schema prints"
# fits FILE
fits() {
    /usr/bin/python3 "$root/tests/tools/schema.py" "$work/schema" "$1" >"$work/said" && grep -q '^good' "$work/said"
}

for model in "$root"/models/*.veh "$root"/models/parts/*.veh "$root"/models/tutorial/*.veh "$root"/models/controllers/*.veh "$root"/models/optimize/*.veh "$root"/tests/data/dump/*.veh "$root"/tests/data/dump/parts/*.veh \
    "$root"/tests/data/laws/*.veh "$root"/tests/data/elements/*.veh "$root"/tests/data/tuning/*.veh "$root"/tests/data/symmetry/*.veh; do
    fits "$model"
    verdict $? "$(cat "$work/said")"
done

# structure is what a schema can see; values that contradict each other are left to the reader
for name in body_key_missing body_key_unknown body_not_map coordinate_angle_points coordinate_axis coordinate_type force_both \
    force_law_stiffness force_law_value force_neither force_type gravity_length include_key inertia_key inertia_length \
    joint_axes_axis joint_axes_flat joint_axes_missing joint_axes_one joint_axis_and_axes joint_axis_missing \
    joint_bodies_three joint_key_foreign joint_length_negative joint_offset_foreign joint_point_missing joint_type \
    joint_type_missing key_unknown load_list mass_negative mass_zero name_bad not_a_map orientation_mixed output_in_foreign \
    output_reaction_body output_reaction_missing output_type parameter_flag port_body_missing port_key point_length powertrain_duration powertrain_idle powertrain_key powertrain_map \
    powertrain_missing powertrain_forward_number powertrain_inertia powertrain_latency powertrain_outputs powertrain_ratio section_list \
    stop_free table_interpolation table_short tire_both tire_key_foreign tire_key_missing tire_key_unknown tire_list tire_neither tire_relaxation_one tire_type \
    torsion_bodies torsion_points version_missing version_zero wheel_radius_missing wheel_side wheel_spin_missing \
    wheel_spin_plain wheel_spin_zero wheel_tire_radius; do
    fits "$root/tests/data/mistakes/$name.veh"
    grep -q '^bad' "$work/said"
    verdict $? "$name fits the schema"
done

"$gicgen" --list-keys >"$work/keys"
/usr/bin/python3 "$root/tests/tools/schema_texts.py" "$work/schema" "$work/keys" >"$work/said" &&
    ! grep '^bad' "$work/said" && [ "$(sed -n '$s/ described$//p' "$work/said")" -gt 60 ]
verdict $? "descriptions of keys: $(cat "$work/said")"
for key in $(sed -n 's/^  \([a-z][a-z0-9_]*\) .*/\1/p' "$work/keys" | sort -u); do
    grep -q "[\`{ ]${key}[\`:]" "$root/models/FORMAT.md" "$root/models/TIRES.md" "$root/models/POWERTRAIN.md" && grep -q "\"$key\": " "$work/schema"
    verdict $? "key '$key' is missing in FORMAT.md, TIRES.md and POWERTRAIN.md, or in the schema"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
