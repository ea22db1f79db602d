import { Differing } from "./Differing";

interface Labelled {
  readonly label?: string | null;
  readonly name?: string;
}

/** In what the scenarios, the ADSs and the methods of a study differ. */
export function StudySettings({ document }: { readonly document: Record<string, unknown> }) {
  const { scenarios, agents, methods } = document as {
    readonly scenarios?: readonly Labelled[];
    readonly agents?: readonly Labelled[];
    readonly methods?: readonly Labelled[];
  };
  const parts = [
    ["Scenarios", scenarios],
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
            documents={items.map(({ label: _label, ...rest }) => rest)}
          />
        ))}
      </div>
    </section>
  );
}
