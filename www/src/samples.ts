/** A body or a piece of one that ships with the page; the meshes share one order of vertices. */
export interface Sample {
  readonly file: string;
  readonly title: string;
  readonly person: string;
  readonly pose: string;
  readonly kind: 'mesh' | 'cloud' | 'piece';
}

/** What ships with the page. */
export interface Samples {
  readonly samples: readonly Sample[];
  /** What the part labels of all of them stand for. */
  readonly parts: readonly string[];
}

const none: Samples = { samples: [], parts: [] };

/** The samples of the manifest; having none is no reason not to work. */
export async function listSamples(): Promise<Samples> {
  try {
    const response = await fetch('./samples/samples.json');
    return response.ok ? ((await response.json()) as Samples) : none;
  } catch {
    return none;
  }
}

/** Two people in two poses, both meshes where there are such. */
export function samplePair(samples: readonly Sample[]): readonly [Sample, Sample] | null {
  const first = samples.find(({ kind }) => kind === 'mesh') ?? samples[0];
  const second =
    samples.find((sample) => sample.kind === 'mesh' && sample.person !== first?.person && sample.pose !== first?.pose) ??
    samples.find((sample) => sample !== first);
  return first && second ? [first, second] : null;
}
