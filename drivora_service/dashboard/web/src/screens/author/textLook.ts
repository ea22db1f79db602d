import { HighlightStyle } from "@codemirror/language";
import type { Extension } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { tags } from "@lezer/highlight";

/** The colours of words; the tokens of the theme reach into the shadow tree. */
export const wordColours = HighlightStyle.define([
  { tag: [tags.propertyName, tags.definition(tags.propertyName)], color: "var(--accent)" },
  { tag: [tags.number, tags.bool, tags.null], color: "var(--ink)" },
  { tag: tags.string, color: "var(--ink-2)" },
  { tag: [tags.comment, tags.punctuation, tags.separator], color: "var(--ink-3)" },
]);

/** The look of a text in the theme of the page. */
export function lookOfText(dark: boolean): Extension {
  return EditorView.theme(
    {
      "&": { height: "100%", backgroundColor: "var(--raised)", color: "var(--ink)" },
      "&.cm-focused": { outline: "none" },
      ".cm-scroller": { fontFamily: "var(--mono)", fontSize: "12px", lineHeight: "1.5" },
      ".cm-gutters": {
        backgroundColor: "var(--raised)",
        color: "var(--ink-3)",
        border: "none",
      },
      ".cm-activeLine, .cm-activeLineGutter": { backgroundColor: "var(--sunk)" },
      ".cm-cursor": { borderLeftColor: "var(--ink)" },
      "&.cm-focused .cm-selectionBackground, .cm-selectionBackground": {
        backgroundColor: "var(--accent-soft) !important",
      },
      ".cm-tooltip": {
        backgroundColor: "var(--raised)",
        color: "var(--ink)",
        border: "1px solid var(--line-strong)",
        fontFamily: "var(--sans)",
        fontSize: "12px",
        maxWidth: "420px",
      },
      ".cm-diagnostic": { borderLeftColor: "var(--violation)" },
    },
    { dark },
  );
}
