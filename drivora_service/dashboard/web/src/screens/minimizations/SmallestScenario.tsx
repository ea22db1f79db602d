import { Copy } from "../../components/Copy";
import { storeFile } from "../../lists/csv";
import { documentText, isActive, type Minimization } from "./minimization";

/** The smallest scenario, to read, copy and download. */
export function SmallestScenario({ minimization }: { readonly minimization: Minimization }) {
  const { id, document, one_minimal } = minimization;
  if (!document) return null;
  const text = documentText(document);
  const standing = isActive(minimization)
    ? "so far"
    : one_minimal
      ? "1-minimal: none of its single reductions fails in the same way"
      : "so far; a single reduction of it may still fail in the same way";
  return (
    <section className="panel smallest" aria-label="Smallest scenario">
      <header>
        <h2>Smallest scenario</h2>
        <span className="quiet">{standing}</span>
        <span className="actions doing">
          <Copy text={text} label="Copy" />
          <button
            type="button"
            onClick={() => storeFile(`minimal-${id}.json`, "application/json", [text])}
          >
            Download
          </button>
        </span>
      </header>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: a part that scrolls is reached by keyboard */}
      <pre className="inside document" tabIndex={0}>
        {text}
      </pre>
    </section>
  );
}
