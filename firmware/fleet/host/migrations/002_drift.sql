-- SPDX-License-Identifier: MIT
-- The sum over many checks in which a slow change shows: Crosier (1988), as core/drift/cusum.hpp computes it.
CREATE FUNCTION crosier_step(state double precision[], x double precision, y double precision, z double precision,
                             k double precision) RETURNS double precision[]
LANGUAGE sql IMMUTABLE PARALLEL SAFE AS $$
  SELECT CASE WHEN v.c <= k THEN ARRAY[0, 0, 0]::double precision[]
              ELSE ARRAY[v.x * (1 - k / v.c), v.y * (1 - k / v.c), v.z * (1 - k / v.c)] END
  FROM (SELECT state[1] + $2 AS x, state[2] + $3 AS y, state[3] + $4 AS z,
               sqrt((state[1] + $2) ^ 2 + (state[2] + $3) ^ 2 + (state[3] + $4) ^ 2) AS c) AS v
$$;

-- crosier(x, y, z, k ORDER BY ...): the sum after all checks, in units of sigma.
CREATE AGGREGATE crosier(double precision, double precision, double precision, double precision) (
  SFUNC = crosier_step, STYPE = double precision[], INITCOND = '{0,0,0}'
);

-- Of the plant: sigma of a check, reference value, threshold, checks of a baseline. One row, written by the host.
CREATE TABLE drift_setting (
  one boolean PRIMARY KEY DEFAULT true CHECK (one),
  sigma_mm double precision NOT NULL CHECK (sigma_mm > 0),
  k double precision NOT NULL CHECK (k >= 0),
  h double precision NOT NULL CHECK (h > 0),
  baseline integer NOT NULL CHECK (baseline >= 1)
);

-- Where each arm stands. A changed signature begins a new baseline.
CREATE TABLE drift (
  node text PRIMARY KEY REFERENCES arm,
  signature text,
  checks integer NOT NULL DEFAULT 0,
  baseline_mm double precision[] NOT NULL DEFAULT '{0,0,0}',
  sum double precision[] NOT NULL DEFAULT '{0,0,0}',
  last_at timestamptz,
  last_mm double precision[],
  verdict text,
  named_at timestamptz                             -- when the sum first passed the threshold
);

CREATE FUNCTION drift_take(arm_node text, check_at timestamptz, check_verdict text, x double precision,
                           y double precision, z double precision) RETURNS void
LANGUAGE plpgsql AS $$
DECLARE
  s drift_setting;
  d drift;
  now_signature text := (SELECT current ->> 'signature' FROM arm WHERE node = arm_node);
BEGIN
  SELECT * INTO s FROM drift_setting;
  IF NOT FOUND THEN RETURN; END IF;
  SELECT * INTO d FROM drift WHERE node = arm_node;
  IF NOT FOUND OR d.signature IS DISTINCT FROM now_signature THEN
    DELETE FROM drift WHERE node = arm_node;
    INSERT INTO drift (node, signature) VALUES (arm_node, now_signature) RETURNING * INTO d;
  END IF;
  IF d.checks < s.baseline THEN
    d.baseline_mm := ARRAY[d.baseline_mm[1] + x / s.baseline, d.baseline_mm[2] + y / s.baseline,
                           d.baseline_mm[3] + z / s.baseline];
  ELSE
    d.sum := crosier_step(d.sum, (x - d.baseline_mm[1]) / s.sigma_mm, (y - d.baseline_mm[2]) / s.sigma_mm,
                          (z - d.baseline_mm[3]) / s.sigma_mm, s.k);
    IF d.named_at IS NULL AND d.sum[1] ^ 2 + d.sum[2] ^ 2 + d.sum[3] ^ 2 > s.h ^ 2 THEN
      d.named_at := check_at;
    END IF;
  END IF;
  UPDATE drift SET checks = d.checks + 1, baseline_mm = d.baseline_mm, sum = d.sum, last_at = check_at,
                   last_mm = ARRAY[x, y, z], verdict = check_verdict, named_at = d.named_at
  WHERE node = arm_node;
END
$$;
