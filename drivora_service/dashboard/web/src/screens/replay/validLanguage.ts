// uPlot asks for number formats of the browser's language when it is loaded, and fails where that
// is no valid tag: browsers without a display take it from LANG, such as `en-US@posix`.
try {
  Intl.getCanonicalLocales(navigator.language);
} catch {
  Object.defineProperty(navigator, "language", { value: "en-US", configurable: true });
}

export {};
