// The server this page came from: what it is asked, and its words when it refuses.

export async function post(address: string, body: unknown): Promise<unknown> {
  return answered(
    await fetch(address, {
      method: "POST",
      headers: { "content-type": "application/json" },
      body: JSON.stringify(body),
    }),
  );
}

/** What the server says; an error with its words if it refuses. */
export async function answered(response: Response): Promise<unknown> {
  const text = await response.text();
  if (response.ok) return JSON.parse(text);
  if (!response.headers.get("content-type")?.startsWith("application/json"))
    throw new Error(text.trim() || response.statusText);
  const { problems } = JSON.parse(text) as { problems: { where: string; what: string; hint: string }[] };
  throw new Error(
    problems.map(({ where, what, hint }) => `${where && `${where}: `}${what}${hint && ` (${hint})`}`).join("\n"),
  );
}
