/** The screens in the order of the top line; `g` and the key go there. */
export const SECTIONS = [{ to: "/runs", name: "Runs", key: "r" }] as const;
