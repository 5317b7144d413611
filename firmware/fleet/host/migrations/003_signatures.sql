-- SPDX-License-Identifier: MIT
-- A row's journal is written by the statement that writes the row: to look it up once more for every row took a third of
-- the time of a batch.
ALTER TABLE row DROP CONSTRAINT row_node_journal_fkey;

-- A signature's document comes in parts, each a row of the cabinet's journal. Those of one document of each arm wait here
-- until all are there; a part of another document drops them.
CREATE TABLE signature_part (
  node text NOT NULL REFERENCES arm,
  hash text NOT NULL CHECK (hash ~ '^[0-9a-f]{64}$'),
  part integer NOT NULL,
  parts integer NOT NULL CHECK (parts BETWEEN 1 AND 64),
  document text NOT NULL,
  PRIMARY KEY (node, part),
  CHECK (part BETWEEN 1 AND parts)
);

-- Documents that were not what their hash says, by the arm that sent them.
CREATE TABLE signature_refused (
  node text PRIMARY KEY REFERENCES arm,
  documents bigint NOT NULL
);

-- Which signature an arm went by, from when on, and what it was told to be worth. No hash: the drawing.
CREATE TABLE worn (
  id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  node text NOT NULL REFERENCES arm,
  hash text,
  since timestamptz NOT NULL,                      -- by the cabinet's clock
  identified_ms double precision,                  -- since 1970-01-01 UTC
  sigma_mm double precision,
  held_out_mm double precision,
  air_c double precision
);
CREATE INDEX worn_node ON worn (node, id);
CREATE INDEX worn_hash ON worn (hash);

CREATE FUNCTION document_take(arm_node text, arm_hash text, number double precision, numbers double precision,
                              piece text) RETURNS void
LANGUAGE plpgsql AS $$
DECLARE
  whole text;
  count_there bigint;
BEGIN
  IF (arm_hash ~ '^[0-9a-f]{64}$' AND numbers BETWEEN 1 AND 64 AND number BETWEEN 1 AND numbers AND piece IS NOT NULL
      AND NOT EXISTS (SELECT FROM signature WHERE hash = arm_hash)) IS NOT TRUE THEN
    RETURN;
  END IF;
  DELETE FROM signature_part WHERE node = arm_node AND (hash <> arm_hash OR parts <> numbers);
  INSERT INTO signature_part VALUES (arm_node, arm_hash, number, numbers, piece)
    ON CONFLICT (node, part) DO UPDATE SET document = excluded.document;
  SELECT count(*), string_agg(document, '' ORDER BY part) INTO count_there, whole FROM signature_part WHERE node = arm_node;
  IF count_there < numbers THEN RETURN; END IF;
  IF encode(sha256(convert_to(whole, 'UTF8')), 'hex') = arm_hash THEN
    INSERT INTO signature (hash, document) VALUES (arm_hash, whole) ON CONFLICT DO NOTHING;
  ELSE
    INSERT INTO signature_refused VALUES (arm_node, 1)
      ON CONFLICT (node) DO UPDATE SET documents = signature_refused.documents + 1;
  END IF;
  DELETE FROM signature_part WHERE node = arm_node;
END
$$;

-- A number of a reading; none where it is no number or as good as none.
CREATE FUNCTION number_of(reading jsonb, key text) RETURNS double precision
LANGUAGE sql IMMUTABLE PARALLEL SAFE AS $$
  SELECT CASE WHEN jsonb_typeof(reading -> key) = 'number' AND abs((reading -> key)::numeric) < 1e15
              THEN (reading -> key)::double precision END
$$;

-- A row that says which signature the arm goes by: news only where it was another before.
CREATE FUNCTION worn_take(arm_node text, row_at timestamptz, reading jsonb) RETURNS void
LANGUAGE sql AS $$
  INSERT INTO worn (node, hash, since, identified_ms, sigma_mm, held_out_mm, air_c)
  SELECT arm_node, reading ->> 'signature', row_at, number_of(reading, 'identified_ms'), number_of(reading, 'sigma_mm'),
         number_of(reading, 'held_out_mm'), number_of(reading, 'air_c')
  WHERE NOT EXISTS (SELECT FROM (SELECT hash FROM worn WHERE node = arm_node ORDER BY id DESC LIMIT 1) AS last
                    WHERE last.hash IS NOT DISTINCT FROM reading ->> 'signature')
$$;

-- What came before there was this table.
SELECT worn_take(node, at, reading) FROM (
  SELECT node, at, reading FROM row WHERE reading ? 'signature' ORDER BY node, received_at, number) AS told;
