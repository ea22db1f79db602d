import type { LightColour } from "./palette";

/** Returns the colour that SUMO's letter for a signal stands for. */
export function colourOf(letter: string | undefined): LightColour {
  if (letter === "G" || letter === "g") return "green";
  if (letter === "y" || letter === "Y") return "yellow";
  if (letter === "r" || letter === "u") return "red";
  return "off";
}
