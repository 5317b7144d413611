-- SPDX-License-Identifier: MIT
-- Documents with maps, gravity and the types of the joints are longer.
ALTER TABLE signature_part DROP CONSTRAINT signature_part_parts_check;
ALTER TABLE signature_part ADD CHECK (parts BETWEEN 1 AND 128);

CREATE OR REPLACE FUNCTION document_take(arm_node text, arm_hash text, number double precision, numbers double precision,
                                         piece text) RETURNS void
LANGUAGE plpgsql AS $$
DECLARE
  whole text;
  count_there bigint;
BEGIN
  IF (arm_hash ~ '^[0-9a-f]{64}$' AND numbers BETWEEN 1 AND 128 AND number BETWEEN 1 AND numbers AND piece IS NOT NULL
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

-- What a document says under a key; none where it says nothing, or no number.
CREATE FUNCTION document_value(document text, key text) RETURNS text
LANGUAGE sql IMMUTABLE PARALLEL SAFE AS $$
  SELECT substring(document FROM '(?:^| )' || key || '=([^ ]*)')
$$;
CREATE FUNCTION document_number(document text, key text) RETURNS double precision
LANGUAGE sql IMMUTABLE PARALLEL SAFE AS $$
  SELECT CASE WHEN value ~ '^-?[0-9]{1,15}([.][0-9]{1,20})?(e[-+]?[0-9]{1,2})?$' THEN value::double precision END
  FROM (SELECT document_value(document, key) AS value) AS told
$$;

-- Every joint of every signature. Map at its knots and gravity by link origin in degrees, of a slide in mm (gravity: per metre
-- of lever); none where the signature has none. Near parallel axes the rows mean something only together.
CREATE VIEW signature_joint AS
SELECT hash, joint,
       coalesce(document_value(document, 'type' || joint), 'revolute') AS type,
       document_number(document, 'theta' || joint || '_deg') AS theta_deg,
       document_number(document, 'd' || joint || '_mm') AS d_mm,
       document_number(document, 'a' || joint || '_mm') AS a_mm,
       document_number(document, 'alpha' || joint || '_deg') AS alpha_deg,
       (SELECT array_agg(step::integer * coalesce(degrees(document_number(document, 'map' || joint || '_step_rad')),
                                                  1000 * document_number(document, 'map' || joint || '_step_m')) ORDER BY knot)
        FROM unnest(string_to_array(document_value(document, 'map' || joint), ',')) WITH ORDINALITY AS steps(step, knot)
        WHERE step ~ '^-?[0-9]{1,5}$') AS map,
       (SELECT jsonb_object_agg(term[1], CASE WHEN document_value(document, 'type' || joint) IS NULL
                                              THEN degrees(term[2]::double precision) ELSE 1000 * term[2]::double precision END)
        FROM regexp_matches(document, ' gravity=' || joint || ',([1-8]),(-?[0-9.]{1,25}(?:e[-+]?[0-9]{1,2})?)(?= |$)', 'g')
             AS term) AS gravity
FROM signature, generate_series(1, 8) AS joint
WHERE document_number(document, 'theta' || joint || '_deg') IS NOT NULL;

-- Two signatures joint by joint: `now` less `before`; of map and gravity the largest change.
CREATE FUNCTION signature_changes(before text, now text)
RETURNS TABLE (joint integer, type text, theta_deg double precision, d_mm double precision, a_mm double precision,
               alpha_deg double precision, map double precision, gravity double precision)
LANGUAGE sql STABLE AS $$
  SELECT b.joint, b.type, b.theta_deg - a.theta_deg, b.d_mm - a.d_mm, b.a_mm - a.a_mm, b.alpha_deg - a.alpha_deg,
         (SELECT max(abs(coalesce(y, 0) - coalesce(x, 0))) FROM unnest(a.map, b.map) AS knots(x, y)),
         (SELECT max(abs(coalesce((b.gravity ->> origin)::double precision, 0) -
                         coalesce((a.gravity ->> origin)::double precision, 0)))
          FROM jsonb_object_keys(coalesce(a.gravity, '{}') || coalesce(b.gravity, '{}')) AS origin)
  FROM signature_joint a JOIN signature_joint b ON b.joint = a.joint AND b.type = a.type
  WHERE a.hash = signature_changes.before AND b.hash = signature_changes.now
  ORDER BY b.joint
$$;
