/** What an error of the page means for its reader. */
export interface Advice {
  readonly title: string;
  readonly says: string;
}

/** Words of browsers for a file of the page that is not there any more. */
const FILE_GONE = /dynamically imported module|module script failed|error loading/i;

export function adviceFor(error: Error): Advice {
  if (FILE_GONE.test(error.message))
    return {
      title: "A part of the page could not be loaded",
      says:
        "The service was updated since this page was opened, or it has stopped. Reload the page; " +
        "if that does not help, look whether the service runs.",
    };
  return {
    title: "This screen cannot be shown",
    says:
      "An error of the page, not of the service: runs and campaigns go on. Reload the page; if it " +
      "comes again, remove filters from the address, and send the report to those who maintain " +
      "your installation.",
  };
}
