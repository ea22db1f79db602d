import { defaultKeymap, history, historyKeymap } from "@codemirror/commands";
import { json } from "@codemirror/lang-json";
import { yaml } from "@codemirror/lang-yaml";
import {
  bracketMatching,
  foldGutter,
  indentOnInput,
  syntaxHighlighting,
} from "@codemirror/language";
import { type Diagnostic, lintGutter, setDiagnostics } from "@codemirror/lint";
import { Compartment, EditorState } from "@codemirror/state";
import {
  drawSelection,
  EditorView,
  highlightActiveLine,
  keymap,
  lineNumbers,
} from "@codemirror/view";
import { useEffect, useRef } from "react";
import { useTheme } from "../../shell/theme";
import type { Language } from "./text";
import { lookOfText, wordColours } from "./textLook";

/** A text of a document, with its mistakes marked. */
export function TextEditor({
  text,
  language,
  marks,
  place,
  onText,
}: {
  readonly text: string;
  readonly language: Language;
  readonly marks: readonly Diagnostic[];
  /** Where the reader is to be led; a new object leads there again. */
  readonly place: { readonly from: number } | undefined;
  readonly onText: (text: string) => void;
}) {
  const frame = useRef<HTMLDivElement>(null);
  const view = useRef<EditorView>(undefined);
  const spoken = useRef(new Compartment());
  const look = useRef(new Compartment());
  const told = useRef(onText);
  told.current = onText;
  const theme = useTheme();
  const first = useRef({ text, language, theme });

  useEffect(() => {
    const host = frame.current;
    if (!host) return;
    // Its styles are allowed inside a shadow tree alone: the page's policy has no inline styles.
    const root = host.shadowRoot ?? host.attachShadow({ mode: "open" });
    const begin = first.current;
    const made = new EditorView({
      parent: root as unknown as Element,
      root,
      state: EditorState.create({
        doc: begin.text,
        extensions: [
          lineNumbers(),
          foldGutter(),
          history(),
          drawSelection(),
          indentOnInput(),
          bracketMatching(),
          highlightActiveLine(),
          lintGutter(),
          syntaxHighlighting(wordColours),
          spoken.current.of(languageOf(begin.language)),
          look.current.of(lookOfText(begin.theme === "dark")),
          EditorView.contentAttributes.of({ "aria-label": "Text of the scenario", tabindex: "0" }),
          keymap.of([...defaultKeymap, ...historyKeymap]),
          EditorView.domEventHandlers({ beforeinput: insertTyped }),
          EditorView.updateListener.of((update) => {
            if (update.docChanged && !update.transactions.some((one) => one.isUserEvent("outside")))
              told.current(update.state.doc.toString());
          }),
        ],
      }),
    });
    view.current = made;
    return () => {
      view.current = undefined;
      made.destroy();
    };
  }, []);

  useEffect(() => {
    view.current?.dispatch({ effects: spoken.current.reconfigure(languageOf(language)) });
  }, [language]);
  useEffect(() => {
    const effects = look.current.reconfigure(lookOfText(theme === "dark"));
    view.current?.dispatch({ effects });
  }, [theme]);
  useEffect(() => {
    const made = view.current;
    if (!made || made.state.doc.toString() === text) return;
    made.dispatch({
      changes: { from: 0, to: made.state.doc.length, insert: text },
      userEvent: "outside",
    });
  }, [text]);
  useEffect(() => {
    const made = view.current;
    if (!made) return;
    const { length } = made.state.doc;
    const inside = marks.map((mark) => ({
      ...mark,
      from: Math.min(mark.from, length),
      to: Math.min(mark.to, length),
    }));
    made.dispatch(setDiagnostics(made.state, inside));
  }, [marks]);
  useEffect(() => {
    const made = view.current;
    if (!made || !place) return;
    const at = Math.min(place.from, made.state.doc.length);
    made.dispatch({
      selection: { anchor: at },
      effects: EditorView.scrollIntoView(at, { y: "center" }),
    });
    made.focus();
  }, [place]);
  return <div ref={frame} className="author-text" />;
}

function languageOf(language: Language) {
  return language === "json" ? json() : yaml();
}

/**
 * Writes what is typed itself.
 *
 * The browser keeps the look of replaced text by inline styles, which the page's policy refuses.
 */
function insertTyped(event: InputEvent, view: EditorView): boolean {
  const { data, inputType, isComposing } = event;
  if (inputType !== "insertText" || data === null || isComposing || view.composing) return false;
  view.dispatch(view.state.replaceSelection(data), {
    userEvent: "input.type",
    scrollIntoView: true,
  });
  event.preventDefault();
  return true;
}
