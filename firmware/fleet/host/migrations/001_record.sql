-- SPDX-License-Identifier: MIT
-- Arms, their journals, every row that came, signatures by what they are.
CREATE TABLE arm (
  node text PRIMARY KEY CHECK (length(node) BETWEEN 1 AND 64),
  online boolean NOT NULL,
  changed_at timestamptz NOT NULL DEFAULT now(),   -- of online
  current jsonb NOT NULL DEFAULT '{}'              -- the newest value of every quantity
);

-- A journal is 64 random bits, kept as the bigint of the same bits. All rows up to `contiguous` that the cabinet still had
-- are in the table `row`: written in the transaction that writes them.
CREATE TABLE journal (
  node text NOT NULL REFERENCES arm,
  journal bigint NOT NULL,
  contiguous bigint NOT NULL CHECK (contiguous >= 0),
  dropped bigint NOT NULL DEFAULT 0,               -- rows that the cabinet lost because its ring was full
  PRIMARY KEY (node, journal)
);

CREATE TABLE row (
  node text NOT NULL,
  journal bigint NOT NULL,
  number bigint NOT NULL,
  at timestamptz NOT NULL,                         -- by the cabinet's clock
  received_at timestamptz NOT NULL DEFAULT clock_timestamp(),
  historical boolean NOT NULL,
  reading jsonb NOT NULL,
  PRIMARY KEY (node, journal, number),
  FOREIGN KEY (node, journal) REFERENCES journal
);
CREATE INDEX row_received ON row USING brin (received_at);
CREATE INDEX row_check ON row (node, number) WHERE reading ? 'dx_mm';

CREATE TABLE signature (
  hash text PRIMARY KEY CHECK (hash = encode(sha256(convert_to(document, 'UTF8')), 'hex')),
  document text NOT NULL,
  added_at timestamptz NOT NULL DEFAULT now()
);
