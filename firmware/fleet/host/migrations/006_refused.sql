-- SPDX-License-Identifier: MIT
-- Rows that the record could not take as they are, as they came, with the reason.
CREATE TABLE row_refused (
  node text NOT NULL REFERENCES arm,
  journal bigint NOT NULL,
  number bigint NOT NULL,
  at timestamptz NOT NULL,
  reading text NOT NULL,
  problem text NOT NULL,
  received_at timestamptz NOT NULL DEFAULT clock_timestamp(),
  PRIMARY KEY (node, journal, number)
);
