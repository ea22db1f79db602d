import type { Diagnostic } from "@codemirror/lint";
import { lazy, Suspense, useEffect, useMemo, useState } from "react";
import type { JsonObject, PlacedProblem } from "../../components/fields/pointers";
import { Loading } from "../../components/States";
import { save } from "../../documents/save";
import { useRemembered } from "../../lists/remembered";
import { type Language, readText, TextPlaces, writeText } from "./text";

const TextEditor = lazy(async () => ({ default: (await import("./TextEditor")).TextEditor }));

/** The scenario as JSON or YAML; what is typed is the scenario as soon as it can be read. */
export function TextPanel({
  scenario,
  problems,
  asked,
  onRead,
  onUnreadable,
}: {
  readonly scenario: JsonObject;
  readonly problems: readonly PlacedProblem[];
  /** Pointer to the place that the reader is led to. */
  readonly asked: string;
  readonly onRead: (document: JsonObject) => void;
  /** Told why the text cannot be read; "" once it can. */
  readonly onUnreadable: (why: string) => void;
}) {
  const [language, setLanguage] = useRemembered<Language>("drivora:author-language", (stored) =>
    stored === "yaml" ? "yaml" : "json",
  );
  const [typed, setTyped] = useState<{ readonly text: string; readonly of: JsonObject }>();
  // What was typed stands as long as it says the same as the scenario.
  const text = typed && typed.of === scenario ? typed.text : writeText(scenario, language);
  const [mistake, setMistake] = useState<Diagnostic>();
  const places = useMemo(() => new TextPlaces(text), [text]);
  const marks = useMemo(
    () => [
      ...(mistake ? [mistake] : []),
      ...problems.map(({ pointer, message }): Diagnostic => {
        return { ...places.rangeOf(pointer), severity: "error", message };
      }),
    ],
    [mistake, problems, places],
  );
  // biome-ignore lint/correctness/useExhaustiveDependencies: led there once for each asking
  const place = useMemo(() => (asked ? places.rangeOf(asked) : undefined), [asked]);
  useEffect(() => () => onUnreadable(""), [onUnreadable]);

  const onText = (now: string) => {
    const read = readText(now, language);
    if ("error" in read) {
      setTyped({ text: now, of: scenario });
      setMistake({ from: read.from, to: read.to, severity: "error", message: read.error });
      onUnreadable(read.error);
      return;
    }
    setMistake(undefined);
    onUnreadable("");
    setTyped({ text: now, of: read.document });
    onRead(read.document);
  };
  return (
    <section className="author-words" aria-label="Text of the scenario">
      <p className="row-of-buttons">
        {(["json", "yaml"] as const).map((one) => (
          <button
            key={one}
            type="button"
            aria-pressed={one === language}
            disabled={mistake !== undefined && one !== language}
            onClick={() => {
              setTyped(undefined);
              setLanguage(one);
            }}
          >
            {one.toUpperCase()}
          </button>
        ))}
        <button type="button" onClick={() => save(`scenario.${language}`, text)}>
          Download
        </button>
      </p>
      <Suspense fallback={<Loading rows={10} />}>
        <TextEditor
          key={language}
          text={text}
          language={language}
          marks={marks}
          place={place}
          onText={onText}
        />
      </Suspense>
    </section>
  );
}
