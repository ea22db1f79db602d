"""``drivora campaign presets``."""

from __future__ import annotations

from drivora_service.cli.terminal.output import print_table
from drivora_service.cli.terminal.output_forms import TABLE, Form, with_forms


@with_forms
def presets(form: Form = TABLE) -> None:
    """Lists the named spaces for `space: {preset: NAME}` in a campaign or a study."""
    from drivora_service.search.space.presets import PRESETS

    if not form.is_table:
        form.print_content(
            [
                {
                    "name": name.value,
                    "description": preset.description,
                    "source": preset.source,
                    "options": preset.changed_options,
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
                ", ".join(f"{key} {value}" for key, value in preset.changed_options.items()),
            )
            for name, preset in PRESETS.items()
        ),
        wrap=("what varies", "options that differ from the default"),
    )
