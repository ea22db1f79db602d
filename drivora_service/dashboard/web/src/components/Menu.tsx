import { type KeyboardEvent, type ReactNode, useEffect, useId, useRef, useState } from "react";

export interface MenuProps {
  /** What the button shows. */
  readonly label: ReactNode;
  readonly title?: string;
  /** Whether what the menu sets is set. */
  readonly active?: boolean;
  readonly opener?: (open: () => void) => void;
  readonly align?: "left" | "right";
  readonly children: (close: () => void) => ReactNode;
}

/** A button with a panel below it: arrows move in it, `escape` and a press elsewhere close it. */
export function Menu({ label, title, active, opener, align = "left", children }: MenuProps) {
  const [open, setOpen] = useState(false);
  const frame = useRef<HTMLDivElement>(null);
  const panel = useRef<HTMLDivElement>(null);
  const button = useRef<HTMLButtonElement>(null);
  const id = useId();
  useEffect(() => opener?.(() => setOpen(true)), [opener]);
  useEffect(() => {
    if (!open) return;
    panel.current?.querySelector<HTMLElement>("input, button, a[href]")?.focus();
    const away = (event: PointerEvent) => {
      if (event.target instanceof Node && !frame.current?.contains(event.target)) setOpen(false);
    };
    document.addEventListener("pointerdown", away);
    return () => document.removeEventListener("pointerdown", away);
  }, [open]);
  const close = () => {
    setOpen(false);
    button.current?.focus();
  };
  const onKeyDown = (event: KeyboardEvent) => {
    if (event.key === "Escape") close();
    else if (event.key === "ArrowDown" || event.key === "ArrowUp")
      moveFocus(panel.current, event.key === "ArrowDown" ? 1 : -1);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return (
    <div ref={frame} className="menu">
      <button
        ref={button}
        type="button"
        className="opens"
        title={title}
        aria-expanded={open}
        aria-controls={open ? id : undefined}
        aria-haspopup="dialog"
        data-active={active}
        onClick={() => setOpen(!open)}
      >
        {label}
      </button>
      {open && (
        // biome-ignore lint/a11y/noStaticElementInteractions: keys of the controls inside it
        <div ref={panel} id={id} className="menu-panel" data-align={align} onKeyDown={onKeyDown}>
          {children(close)}
        </div>
      )}
    </div>
  );
}

function moveFocus(panel: HTMLElement | null, by: number): void {
  const stops = [...(panel?.querySelectorAll<HTMLElement>("input, button, a[href]") ?? [])];
  const now = stops.indexOf(document.activeElement as HTMLElement);
  stops[(now + by + stops.length) % stops.length]?.focus();
}
