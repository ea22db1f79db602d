import { type ReactNode, useEffect, useRef } from "react";
import { fieldId, Problems } from "../../components/fields/Field";
import type { PlacedProblem } from "../../components/fields/pointers";

/** A part of a form, with the problems of the place that it is for. */
export function Section({
  pointer,
  title,
  says,
  problems = [],
  children,
}: {
  readonly pointer: string;
  readonly title: string;
  readonly says?: ReactNode;
  readonly problems?: readonly PlacedProblem[];
  readonly children: ReactNode;
}) {
  return (
    <section className="panel" id={fieldId(pointer)} tabIndex={-1} aria-label={title}>
      <header>
        <h2>{title}</h2>
        {says && <span className="quiet">{says}</span>}
      </header>
      <div className="inside stack">
        {problems.length > 0 && (
          <div>
            <Problems problems={problems} />
          </div>
        )}
        {children}
      </div>
    </section>
  );
}

/** A part of a form that most readers do not need; it opens itself when there is a problem in it. */
export function Folded({
  title,
  says,
  hasProblem = false,
  children,
}: {
  readonly title: string;
  readonly says?: string;
  readonly hasProblem?: boolean;
  readonly children: ReactNode;
}) {
  const details = useRef<HTMLDetailsElement>(null);
  useEffect(() => {
    if (hasProblem && details.current) details.current.open = true;
  }, [hasProblem]);
  return (
    <details ref={details} className="folded">
      <summary>
        {title} {says && <span className="quiet">{says}</span>}
      </summary>
      {children}
    </details>
  );
}
