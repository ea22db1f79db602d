import { Differing } from "./Differing";

interface Labelled {
  readonly label?: string | null;
  readonly name?: string;
  readonly space?: unknown;
}

/** In what the scenarios, the ADSs and the methods of a study differ. */
export function StudySettings({ document }: { readonly document: Record<string, unknown> }) {
  const { scenarios, agents, methods, space } = document as {
    readonly space?: unknown;
    readonly scenarios?: readonly Labelled[];
    readonly agents?: readonly Labelled[];
    readonly methods?: readonly Labelled[];
  };
  const parts = [
    // A scenario without a space of its own has that of the study.
    ["Scenarios", scenarios?.map((scenario) => ({ ...scenario, space: scenario.space ?? space }))],
    ["ADSs", agents],
    ["Methods", methods],
  ] as const;
  return (
    <section className="panel">
      <header>
        <h2>Settings that differ</h2>
      </header>
      <div className="inside stack">
        {parts.map(([title, items = []]) => (
          <Differing
            key={title}
            title={title}
            names={items.map(({ label, name }, place) => label || name || `${title} ${place + 1}`)}
            documents={items.map(({ label: _label, name: _name, ...rest }) => rest)}
          />
        ))}
      </div>
    </section>
  );
}
