"""``drivora campaign presets``."""

from __future__ import annotations

from dataclasses import fields

from drivora_service.cli.output import JsonOption, print_json, print_table


def presets(as_json: JsonOption = False) -> None:
    """Lists the named spaces for `space: {preset: NAME}` in a campaign or a study."""
    from drivora_service.search.space.options import SpaceOptions
    from drivora_service.search.space.presets import PRESETS

    default = SpaceOptions()
    changed = {
        name: {
            one.name: getattr(preset.options, one.name)
            for one in fields(SpaceOptions)
            if getattr(preset.options, one.name) != getattr(default, one.name)
        }
        for name, preset in PRESETS.items()
    }
    if as_json:
        print_json(
            [
                {
                    "name": name.value,
                    "description": preset.description,
                    "source": preset.source,
                    "options": changed[name],
                }
                for name, preset in PRESETS.items()
            ]
        )
        return
    print_table(
        "",
        ("preset", "what varies", "options that differ from the default"),
        (
            (
                name.value,
                preset.description,
                ", ".join(f"{key} {value}" for key, value in changed[name].items()),
            )
            for name, preset in PRESETS.items()
        ),
        wrap=("what varies", "options that differ from the default"),
    )
