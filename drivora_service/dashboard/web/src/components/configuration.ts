/** What names an ADS with its parameters: runs, failures and campaigns have it. */
export interface Configured {
  /** Its name with the parameters that differ from its defaults. */
  readonly configuration: string;
  /** Short id of it with all its parameters; empty where versions did not record it. */
  readonly configuration_id: string;
}

/** Returns the words and the id, for a hint. */
export function adsHint({ configuration, configuration_id }: Configured): string {
  return configuration_id ? `${configuration} (${configuration_id})` : configuration;
}

/** Returns a filter of runs or failures by ADS with parameters: how many each has, by id. */
export function configurationFilter(
  configurations: readonly { readonly id: string; readonly words: string; readonly runs: number }[],
) {
  return {
    name: "configuration",
    title: "Parameters",
    single: true,
    counts: Object.fromEntries(configurations.map(({ id, runs }) => [id, runs])),
    words: Object.fromEntries(configurations.map(({ id, words }) => [id, words])),
    hint: "The ADS with the parameters that differ from its defaults",
  };
}
