import { type ComponentType, type KeyboardEvent, useState } from "react";
import type { Look } from "./jsonSchema";
import type { Json } from "./pointers";
import { jsonTyped, listTyped, numberTyped, stepped, textOf } from "./typed";

export interface ControlProps {
  readonly id: string;
  readonly value: Json;
  readonly isNullable: boolean;
  readonly isInvalid: boolean;
  readonly describedBy: string;
  readonly onChange: (value: Json | undefined) => void;
}

interface Shown extends ControlProps {
  readonly look: Look;
}

/** Returns the control for values of a look. */
export function controlFor(look: Look): ComponentType<Shown> {
  switch (look.kind) {
    case "number":
      return NumberControl;
    case "choice":
      return ChoiceControl;
    case "switch":
      return SwitchControl;
    case "json":
      return JsonControl;
    default:
      return TextControl;
  }
}

/** Keeps what is being typed as it is until the field is left. */
function useTyped(
  value: Json,
  read: (text: string) => Json | undefined,
  onChange: Shown["onChange"],
) {
  const [typed, setTyped] = useState<string>();
  return {
    value: typed ?? textOf(value),
    onChange: (event: { readonly target: { readonly value: string } }) => {
      setTyped(event.target.value);
      onChange(read(event.target.value));
    },
    onBlur: () => setTyped(undefined),
    set: (next: number) => {
      setTyped(undefined);
      onChange(next);
    },
  };
}

function NumberControl({ id, value, isInvalid, describedBy, onChange, look }: Shown) {
  const { set, ...typed } = useTyped(value, numberTyped, onChange);
  if (look.kind !== "number") return null;
  const step = (event: KeyboardEvent) => {
    const direction = { ArrowUp: 1, ArrowDown: -1 }[event.key] as 1 | -1 | undefined;
    if (direction === undefined || typeof value === "string") return;
    event.preventDefault();
    set(stepped(typeof value === "number" ? value : 0, direction, look));
  };
  return (
    <input
      {...typed}
      id={id}
      className="number"
      role="spinbutton"
      inputMode={look.isWhole ? "numeric" : "decimal"}
      autoComplete="off"
      aria-invalid={isInvalid}
      aria-describedby={describedBy}
      aria-valuemin={look.least}
      aria-valuemax={look.most}
      aria-valuenow={typeof value === "number" ? value : undefined}
      onKeyDown={step}
    />
  );
}

function ChoiceControl({ id, value, isNullable, isInvalid, describedBy, onChange, look }: Shown) {
  if (look.kind !== "choice") return null;
  const known = look.values.some((one) => one === value);
  return (
    <select
      id={id}
      value={known ? String(value) : ""}
      aria-invalid={isInvalid}
      aria-describedby={describedBy}
      onChange={({ target }) => onChange(look.values.find((one) => String(one) === target.value))}
    >
      {(isNullable || !known) && <option value="">not given</option>}
      {look.values.map((one) => (
        <option key={one} value={String(one)}>
          {String(one)}
        </option>
      ))}
    </select>
  );
}

function SwitchControl({ id, value, isNullable, isInvalid, describedBy, onChange }: Shown) {
  if (isNullable)
    return (
      <select
        id={id}
        value={value === null ? "" : String(value)}
        aria-invalid={isInvalid}
        aria-describedby={describedBy}
        onChange={({ target }) =>
          onChange(target.value === "" ? undefined : target.value === "true")
        }
      >
        <option value="">not given</option>
        <option value="true">yes</option>
        <option value="false">no</option>
      </select>
    );
  return (
    <input
      id={id}
      type="checkbox"
      checked={value === true}
      aria-invalid={isInvalid}
      aria-describedby={describedBy}
      onChange={({ target }) => onChange(target.checked)}
    />
  );
}

function TextControl({ id, value, isInvalid, describedBy, onChange, look }: Shown) {
  const read = (text: string) =>
    look.kind === "list" ? listTyped(text, look.ofNumbers) : text === "" ? undefined : text;
  const { set: _, ...typed } = useTyped(value, read, onChange);
  return (
    <input
      {...typed}
      id={id}
      maxLength={look.kind === "text" ? look.longest : undefined}
      autoComplete="off"
      spellCheck={false}
      aria-invalid={isInvalid}
      aria-describedby={describedBy}
    />
  );
}

function JsonControl({ id, value, isInvalid, describedBy, onChange }: Shown) {
  const { set: _, ...typed } = useTyped(value, jsonTyped, onChange);
  return (
    <textarea
      {...typed}
      id={id}
      rows={2}
      spellCheck={false}
      placeholder="JSON"
      aria-invalid={isInvalid}
      aria-describedby={describedBy}
    />
  );
}
