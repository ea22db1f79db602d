import { type ReactNode, useEffect, useRef } from "react";

/** Asks before something is done that cannot be undone. */
export function Confirm({
  title,
  action,
  children,
  onYes,
  onClose,
}: {
  readonly title: string;
  /** The words of the button that does it. */
  readonly action: string;
  readonly children: ReactNode;
  readonly onYes: () => void;
  readonly onClose: () => void;
}) {
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => dialog.current?.showModal(), []);
  return (
    // biome-ignore lint/a11y/useKeyWithClickEvents: nothing is done here but to keep clicks inside
    <dialog
      ref={dialog}
      className="confirm"
      onClose={onClose}
      onClick={(event) => event.stopPropagation()}
      aria-labelledby="confirm-title"
    >
      <h2 id="confirm-title">{title}</h2>
      <p>{children}</p>
      <form method="dialog">
        <button type="submit">Keep</button>
        <button type="submit" className="primary" onClick={onYes}>
          {action}
        </button>
      </form>
    </dialog>
  );
}
