-- SPDX-License-Identifier: MIT
-- A predicted error has the region that it is of, a validation its poses, and both the number of the signature in the store
-- of its controller. What was predicted before there was a region is of none that is known.
ALTER TABLE worn RENAME COLUMN sigma_mm TO predicted_tool_error_mm;
ALTER TABLE worn RENAME COLUMN held_out_mm TO validation_rms_mm;
ALTER TABLE worn ADD COLUMN number double precision;
ALTER TABLE worn ADD COLUMN predicted_region text;
ALTER TABLE worn ADD COLUMN validation_poses double precision;

CREATE OR REPLACE FUNCTION worn_take(arm_node text, row_at timestamptz, reading jsonb) RETURNS void
LANGUAGE sql AS $$
  INSERT INTO worn (node, hash, since, identified_ms, predicted_tool_error_mm, validation_rms_mm, air_c, number, predicted_region,
                    validation_poses)
  SELECT arm_node, reading ->> 'signature', row_at, number_of(reading, 'identified_ms'),
         number_of(reading, 'predicted_tool_error_mm'), number_of(reading, 'validation_rms_mm'), number_of(reading, 'air_c'),
         number_of(reading, 'signature_number'), reading ->> 'predicted_region', number_of(reading, 'validation_poses')
  WHERE NOT EXISTS (SELECT FROM (SELECT hash, number FROM worn WHERE node = arm_node ORDER BY id DESC LIMIT 1) AS last
                    WHERE last.hash IS NOT DISTINCT FROM reading ->> 'signature'
                      AND last.number IS NOT DISTINCT FROM number_of(reading, 'signature_number'))
$$;

-- Figures of a signature that is not named with them are no longer kept as those of the arm.
UPDATE arm SET current = current - ARRAY['sigma_mm', 'held_out_mm', 'identified_ms', 'air_c'];
