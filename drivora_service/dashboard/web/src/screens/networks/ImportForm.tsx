import { useMutation, useQueryClient } from "@tanstack/react-query";
import { type FormEvent, useEffect, useRef, useState } from "react";
import { Problem } from "../../api/client";
import { Imported } from "./Imported";
import { FORMATS, type Format, formatOf, isNetworkName, proposedName } from "./networkFile";
import { Cancelled, sendNetwork } from "./sendNetwork";

/** Name and format of the network in a file, and what became of its import. */
export function ImportForm({
  file,
  onBusy,
}: {
  readonly file: File;
  readonly onBusy: (busy: boolean) => void;
}) {
  const queries = useQueryClient();
  const [name, setName] = useState(() => proposedName(file.name));
  const [format, setFormat] = useState<Format | "">(() => formatOf(file.name) ?? "");
  const [sent, setSent] = useState(0);
  const going = useRef<AbortController>(undefined);
  const named = useRef<HTMLInputElement>(null);
  // Enter imports what was chosen.
  useEffect(() => named.current?.focus(), []);
  const send = useMutation({
    mutationFn: (replace: boolean) => {
      going.current = new AbortController();
      const { signal } = going.current;
      setSent(0);
      if (format === "") throw new Error("Choose the format of the file.");
      return sendNetwork(file, { name, format, replace, onSent: setSent, signal });
    },
    onMutate: () => onBusy(true),
    onSettled: () => onBusy(false),
    // The list, and what is known of the network that was replaced.
    onSuccess: () => queries.invalidateQueries({ queryKey: ["network"] }),
  });
  useEffect(
    () => () => {
      going.current?.abort();
      onBusy(false);
    },
    [onBusy],
  );
  if (send.isSuccess) return <Imported network={send.data} />;

  const submit = (event: FormEvent) => {
    event.preventDefault();
    if (isNetworkName(name) && format !== "" && !send.isPending) send.mutate(false);
  };
  return (
    <form onSubmit={submit}>
      <p className="chosen">
        <strong>{file.name}</strong> <span className="quiet">{megabytes(file.size)}</span>
      </p>
      <div className="fields">
        <label>
          Name
          <input
            ref={named}
            value={name}
            disabled={send.isPending}
            spellCheck={false}
            autoComplete="off"
            aria-invalid={!isNetworkName(name)}
            aria-describedby="import-name"
            onChange={(event) => {
              setName(event.target.value);
              // What was refused was another name.
              send.reset();
            }}
          />
        </label>
        <label>
          Format
          <select
            value={format}
            disabled={send.isPending}
            onChange={(event) => {
              setFormat(event.target.value as Format | "");
              send.reset();
            }}
          >
            {format === "" && <option value="">Choose</option>}
            {Object.entries(FORMATS).map(([value, { title }]) => (
              <option key={value} value={value}>
                {title}
              </option>
            ))}
          </select>
        </label>
        {send.isPending ? (
          <button type="button" onClick={() => going.current?.abort()}>
            Cancel
          </button>
        ) : (
          <button
            type="submit"
            className="primary"
            disabled={!isNetworkName(name) || format === ""}
          >
            Import
          </button>
        )}
      </div>
      <p id="import-name" className={isNetworkName(name) ? "hidden-visually" : "hint"}>
        A name has 1 to 64 letters, digits, <code>-</code> and <code>_</code>.
      </p>
      {send.isPending && <Sent share={sent} of={file.size} />}
      {send.isError && (
        <NotImported
          error={send.error}
          name={name}
          onReplace={() => send.mutate(true)}
          wasReplacing={send.variables}
        />
      )}
    </form>
  );
}

function Sent({ share, of }: { readonly share: number; readonly of: number }) {
  const isSent = share >= 1;
  return (
    <div className="sent">
      <progress aria-label="Sent" {...(isSent ? {} : { value: share })} />
      <span role="status">
        {isSent ? "Sent. The service reads the network, which takes up to two minutes." : "Sending"}
      </span>
      {!isSent && (
        <span className="quiet" aria-hidden="true">
          {megabytes(share * of)} of {megabytes(of)}
        </span>
      )}
    </div>
  );
}

function NotImported({
  error,
  name,
  wasReplacing,
  onReplace,
}: {
  readonly error: Error;
  readonly name: string;
  readonly wasReplacing: boolean;
  readonly onReplace: () => void;
}) {
  if (error instanceof Cancelled) return <p role="status">Cancelled; nothing was imported.</p>;
  const problems = error instanceof Problem ? error.problems : [];
  const isTaken = problems.some(({ code }) => code === "network_imported");
  return (
    <div role="alert" className="not-imported">
      <p>{error.message}</p>
      <ul>
        {problems
          .filter(({ message }) => message !== error.message)
          .map(({ message }) => (
            <li key={message}>{message}</li>
          ))}
      </ul>
      {isTaken && !wasReplacing && (
        <button type="button" onClick={onReplace}>
          Replace {name}
        </button>
      )}
    </div>
  );
}

function megabytes(bytes: number): string {
  return bytes < 100_000 ? `${Math.ceil(bytes / 1000)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}
