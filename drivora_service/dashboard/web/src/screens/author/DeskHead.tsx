import { useState } from "react";
import type { Schemas } from "../../api/client";
import { FileChoice } from "./FileChoice";
import type { Desk } from "./useDesk";

/** How things stand with the scenario, and what can be done with the whole of it. */
export function DeskHead({ desk }: { readonly desk: Desk }) {
  const { draft } = desk;
  const [refusal, setRefusal] = useState("");
  const { error } = desk;
  const told = refusal || (error instanceof Error ? error.message : "");
  return (
    <>
      <div className="head">
        <h1>Scenario on {desk.geometry.name}</h1>
        <p className="answer" role="status">
          {answerOf(desk.inspection, desk.isSeen, desk.unreadable)}
        </p>
        <div className="actions">
          <button
            type="button"
            onClick={draft.undo}
            disabled={!draft.canUndo}
            title="One step back (u)"
          >
            Undo
          </button>
          <button
            type="button"
            onClick={draft.redo}
            disabled={!draft.canRedo}
            title="One step forward again (y)"
          >
            Redo
          </button>
          <button type="button" onClick={() => draft.open({})} title="Begin with a network">
            New
          </button>
          <FileChoice onOpen={draft.replace} onRefused={setRefusal} />
          <button
            type="button"
            onClick={desk.vary}
            disabled={!desk.mayVary}
            title="Search failures in variations of this scenario"
          >
            Vary
          </button>
          <button
            type="button"
            className="primary"
            onClick={desk.start}
            disabled={!desk.canRun}
            title="Run it and see it here (x)"
          >
            Run
          </button>
        </div>
      </div>
      {told && (
        <p role="alert" className="problem">
          {told}
        </p>
      )}
    </>
  );
}

function answerOf(
  inspection: Schemas["Inspection"] | undefined,
  isSeen: boolean,
  unreadable: string,
): string {
  if (unreadable) return "The text cannot be read";
  if (!inspection) return "Being checked";
  const { problems, notes } = inspection;
  const count = problems.length;
  if (count > 0) return `${count} ${count === 1 ? "problem" : "problems"}: it cannot be run yet`;
  const told =
    notes.length === 0 ? "" : `, ${notes.length} ${notes.length === 1 ? "note" : "notes"}`;
  return isSeen ? `It can be run${told}` : "Being checked";
}
