import { type ReactNode, useId, useRef } from "react";

const WIDTH_PX = 360;
const GAP_PX = 6;

/** A name that a click explains, without leaving the screen. */
export function Help({ name, children }: { readonly name: string; readonly children: ReactNode }) {
  const id = useId();
  const button = useRef<HTMLButtonElement>(null);
  const place = (popover: HTMLDivElement) => {
    const at = button.current?.getBoundingClientRect();
    if (!at) return;
    const left = Math.max(8, Math.min(at.left, window.innerWidth - WIDTH_PX - 8));
    const below = at.bottom + GAP_PX;
    const fits = below + popover.offsetHeight < window.innerHeight;
    popover.style.left = `${left}px`;
    popover.style.top = `${fits ? below : Math.max(8, at.top - GAP_PX - popover.offsetHeight)}px`;
  };
  return (
    <>
      <button
        ref={button}
        type="button"
        className="plain help"
        popoverTarget={id}
        title={`What is ${name}?`}
      >
        {name}
      </button>
      <div
        id={id}
        popover="auto"
        className="help-text"
        onToggle={(event) => {
          if (event.newState === "open") place(event.currentTarget);
        }}
      >
        {children}
      </div>
    </>
  );
}
