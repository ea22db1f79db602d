import { type ReactNode, useMemo } from "react";
import type { Search } from "../../address";
import { problemsAt } from "../../components/fields/pointers";
import { Loading, Refused } from "../../components/States";
import { useScope } from "../../shell/session";
import { BudgetSection } from "./BudgetSection";
import { type Beginning, useBeginning } from "./beginning";
import { type Catalogues, presetOptions, useCatalogues } from "./catalogues";
import { countedInWords, countingAsDefined } from "./counting";
import { DocumentView } from "./DocumentView";
import { type Draft, documentOf, emptyDraft, type Kind, nameOf, withSetting } from "./draft";
import type { Form } from "./form";
import { OracleSection } from "./OracleSection";
import { ScenarioSection } from "./ScenarioSection";
import { SpaceSection } from "./SpaceSection";
import { draftOf } from "./stored";
import { useDraft } from "./useDraft";
import { useValidation, type Validation } from "./useValidation";
import "./compose.css";

interface Asked {
  /** What counts as a failure, in words. */
  readonly counted: string;
  readonly draft: Draft;
  readonly document: ReturnType<typeof documentOf>;
}

export interface ComposeProps<Answer> {
  readonly kind: Kind;
  readonly title: string;
  readonly search: Search;
  readonly validate: (document: Asked["document"], signal: AbortSignal) => Promise<Answer>;
  /** The parts of the form for ADSs and methods. */
  readonly who: (form: Form) => ReactNode;
  /** What stands beside the form: whether it can be started, and the button. */
  readonly outcome: (asked: Asked, validation: Validation<Answer>) => ReactNode;
}

/** A form for a campaign or a study: what it holds is checked while it is filled in. */
export function Compose<Answer>(props: ComposeProps<Answer>) {
  const catalogues = useCatalogues();
  const beginning = useBeginning(props.kind, props.search);
  const error = catalogues.error ?? beginning.error;
  if (error) {
    const again = () => {
      catalogues.again();
      if (beginning.isError) void beginning.refetch();
    };
    return <Refused error={error} onRepeat={again} />;
  }
  if (!catalogues.data || !beginning.data) return <Loading rows={12} />;
  return (
    <Loaded
      key={beginning.data.source}
      {...props}
      catalogues={catalogues.data}
      beginning={beginning.data}
    />
  );
}

function Loaded<Answer>({
  kind,
  title,
  validate,
  who,
  outcome,
  catalogues,
  beginning,
}: ComposeProps<Answer> & {
  readonly catalogues: Catalogues;
  readonly beginning: Beginning;
}) {
  const first = useMemo(
    () => firstDraft(kind, catalogues, beginning),
    [kind, catalogues, beginning],
  );
  const { draft, change, isChanged, discard } = useDraft(kind, beginning.source, first);
  const document = useMemo(() => documentOf(kind, draft), [kind, draft]);
  const counted = countedInWords(draft);
  const hasScenario = draft.scenarios.length > 0;
  const { maySubmit } = useScope();
  // Who may not start is not answered.
  const validation = useValidation(hasScenario && maySubmit ? document : undefined, validate);
  const form: Form = {
    kind,
    catalogues,
    draft,
    change,
    set: (pointer, value) => change((now) => withSetting(now, pointer, value)),
    problemsOf: (pointer, options) => problemsAt(validation.problems, pointer, options),
  };
  return (
    <>
      <div className="head">
        <h1>{title}</h1>
        <div className="actions">
          {isChanged && (
            <button type="button" onClick={discard}>
              Begin again
            </button>
          )}
        </div>
      </div>
      <div className="compose">
        <div className="stack">
          <ScenarioSection form={form} refusal={beginning.refusal} />
          {who(form)}
          <BudgetSection form={form} />
          <SpaceSection form={form} />
          <OracleSection form={form} />
        </div>
        <div className="stack beside">
          {outcome({ counted, draft, document }, validation)}
          <DocumentView kind={kind} name={nameOf(kind, draft)} document={document} />
        </div>
      </div>
    </>
  );
}

function firstDraft(kind: Kind, catalogues: Catalogues, { scenarios, stored }: Beginning): Draft {
  if (!stored) return countingAsDefined({ ...emptyDraft(kind), scenarios });
  const { definitions, presets } = catalogues;
  const { document, label } = stored;
  return draftOf(kind, document, { definitions, presets: presetOptions(presets), label });
}
