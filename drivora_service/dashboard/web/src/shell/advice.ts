import { ScreenNotLoaded } from "../screen";

/** What an error of the page means for its reader. */
export interface Advice {
  readonly title: string;
  readonly says: string;
}

export function adviceFor(error: Error): Advice {
  if (error instanceof ScreenNotLoaded)
    return {
      title: "A part of the page could not be loaded",
      says:
        "The service was updated since this page was opened. Reload the page; if that does not " +
        "help, send the report to those who maintain your installation.",
    };
  return {
    title: "This screen cannot be shown",
    says:
      "An error of the page, not of the service: runs and campaigns go on. Reload the page; if it " +
      "comes again, remove filters from the address, and send the report to those who maintain " +
      "your installation.",
  };
}
