/** The two scans: a match goes from A to B, its reverse from B to A. */
export type Side = 'a' | 'b';

export const sides = ['a', 'b'] as const;

export const opposite = (side: Side): Side => (side === 'a' ? 'b' : 'a');

/** How a side is called on the page. */
export const letter = (side: Side): string => side.toUpperCase();
