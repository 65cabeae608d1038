# SPDX-License-Identifier: MIT
"""scale.py MODEL [length=S] [mass=M] [body=PATTERN:M] [stiffness=K]: the model, with what it includes, as JSON.

length, mass: every length times S, every mass times M, at the same times: a model whose motion is the same but for
units. body: masses and inertias of the bodies whose names match times M. stiffness: of every spring, N/m."""
import fnmatch
import json
import os
import sys

import yaml


def load(path):
    with open(path, encoding='utf-8') as file:
        own = yaml.safe_load(file)
    whole = {}
    includes = own.pop('include', [])
    for part in includes if isinstance(includes, list) else [includes]:
        for key, value in load(os.path.join(os.path.dirname(path), part)).items():
            if isinstance(value, dict) and isinstance(whole.get(key), dict):
                whole[key].update(value)
            else:
                whole[key] = value
    for key, value in own.items():
        if isinstance(value, dict) and isinstance(whole.get(key), dict):
            whole[key].update(value)
        else:
            whole[key] = value
    return whole


def times(value, factor):
    """Numbers, lists and maps of them; names stay."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return value * factor
    if isinstance(value, list):
        return [times(v, factor) for v in value]
    if isinstance(value, dict):
        return {k: times(v, factor) for k, v in value.items()}
    return value


LENGTHS = ('com', 'position', 'point', 'points', 'center', 'length', 'offset', 'radius', 'range', 'design', 'initial',
           'free', 'low', 'high', 'fade')


def main():
    model = load(sys.argv[1])
    for argument in sys.argv[2:]:
        key, value = argument.split('=')
        if key == 'length':
            s = float(value)
            model['gravity'] = times(model.get('gravity', [0, 0, -9.81]), s)
            model['points'] = times(model.get('points', {}), s)
            for section in ('bodies', 'joints', 'coordinates', 'forces', 'wheels', 'outputs'):
                for entry in model.get(section, {}).values():
                    if section == 'wheels':
                        entry.setdefault('fade', 0.01)
                    for name in LENGTHS:
                        if name in entry:
                            entry[name] = times(entry[name], s)
                    if 'inertia' in entry:
                        entry['inertia'] = times(entry['inertia'], s * s)
        elif key in ('mass', 'body'):
            pattern, factor = value.split(':') if key == 'body' else ('*', value)
            for name, body in model['bodies'].items():
                if fnmatch.fnmatch(name, pattern):
                    for part in ('mass', 'inertia'):
                        body[part] = times(body[part], float(factor))
            for section in ('forces', 'wheels') if key == 'mass' else ():
                for entry in model.get(section, {}).values():
                    for part in ('stiffness', 'damping'):
                        if part in entry:
                            entry[part] = times(entry[part], float(factor))
        elif key == 'stiffness':
            for entry in model['forces'].values():
                entry['stiffness'] = float(value)
    json.dump(model, sys.stdout, indent=1)


main()
